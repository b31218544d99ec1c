// Chromosomes: validity, random ones, fitness.
#include "host_sim/grid/agents/chromosome.h"

namespace screed {
namespace {

// With n pick-ups and n deposits there are C(20, 2n) places for them, one order, and 8^(20 - 2n)
// steps for the other genes. The share of all chromosomes with at most n = 1, 2, ... pairs, in
// 2^-32; the last one takes the rest.
constexpr uint32_t kPairsUpTo[] = {2960352044U, 4139867312U, 4287306721U, 4294793878U,
                                   4294965459U, 4294967287U, 4294967295U};

uint8_t random_pairs(GridRandom& random) {
  const uint32_t draw = random.next();
  uint8_t pairs = 1;
  for (const uint32_t limit : kPairsUpTo) {
    if (draw < limit) break;
    ++pairs;
  }
  return pairs;
}

/// A random set of `count` places out of kGenes as a bit mask (R. Floyd's algorithm, Bentley 1987).
uint32_t random_places(GridRandom& random, uint8_t count) {
  uint32_t places = 0;
  for (uint8_t last = static_cast<uint8_t>(kGenes - count); last < kGenes; ++last) {
    const uint32_t bit = static_cast<uint32_t>(1) << random.below(static_cast<uint16_t>(last + 1));
    places |= (places & bit) == 0 ? bit : static_cast<uint32_t>(1) << last;
  }
  return places;
}

}  // namespace

bool is_valid(const Chromosome& chromosome) {
  uint8_t pick_ups = 0;
  uint8_t deposits = 0;
  for (const uint8_t gene : chromosome.genes) {
    if (gene == kGenePickUp) {
      if (deposits != 0) return false;
      ++pick_ups;
    } else if (gene == kGeneDeposit) {
      ++deposits;
    } else if (gene > kGeneDeposit) {
      return false;
    }
  }
  return pick_ups == deposits && pick_ups != 0;
}

Chromosome random_chromosome(GridRandom& random) {
  const uint8_t pairs = random_pairs(random);
  uint32_t places = random_places(random, static_cast<uint8_t>(2 * pairs));
  uint8_t operations = 0;
  uint32_t steps = 0;
  Chromosome chromosome;
  for (uint8_t i = 0; i < kGenes; ++i) {
    if (i % 10 == 0) steps = random.next();  // three bits a gene
    uint8_t gene = static_cast<uint8_t>(steps & 7U);
    steps >>= 3;
    if ((places & 1U) != 0) {
      gene = operations < pairs ? kGenePickUp : kGeneDeposit;
      ++operations;
    }
    places >>= 1;
    chromosome.genes[i] = gene;
  }
  return chromosome;
}

bool Fitness::better_than(const Fitness& other) const {
  const uint32_t here =
      static_cast<uint32_t>(positive) * (other.operations == 0 ? 1U : other.operations);
  const uint32_t there =
      static_cast<uint32_t>(other.positive) * (operations == 0 ? 1U : operations);
  return here > there;
}

bool Fitness::below(Probability threshold) const {
  if (operations == 0) return threshold != 0;
  return (static_cast<uint32_t>(positive) << 16) < threshold * operations;
}

}  // namespace screed
