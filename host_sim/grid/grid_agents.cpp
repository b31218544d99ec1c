// The agents: what they remember, when they pick up and deposit, where they step.
#include "host_sim/grid/grid_agents.h"

#include "firmware/math/fixed.h"

namespace screed {

void HeightMemory::add(uint16_t height) {
  if (count_ == length_) {
    sum_ -= samples_[oldest_];
  } else {
    ++count_;
  }
  samples_[oldest_] = height;
  sum_ += height;
  oldest_ = oldest_ + 1 == length_ ? static_cast<uint8_t>(0) : static_cast<uint8_t>(oldest_ + 1);
}

// The response-threshold curves in fixed point.

namespace {

/// a / b as Q16 for a <= b, squared.
Probability squared_ratio(uint32_t a_q8, uint32_t b_q8) {
  // Heights of 256 and more, whose Q8 value leaves no room for 16 more digits, lose eight of them.
  while (a_q8 > 0xFFFFU) {
    a_q8 >>= 8;
    b_q8 >>= 8;
  }
  const uint32_t ratio = (a_q8 << 16) / b_q8;
  if (ratio >= kAlways) return kAlways;
  return (ratio * ratio) >> 16;
}

}  // namespace

Probability response_pick_up(uint16_t height, uint16_t k_q8) {
  const uint32_t height_q8 = static_cast<uint32_t>(height) << 8;
  return squared_ratio(height_q8, height_q8 + k_q8);
}

Probability response_deposit(uint16_t height, uint16_t k_q8) {
  const uint32_t height_q8 = static_cast<uint32_t>(height) << 8;
  return squared_ratio(k_q8, height_q8 + k_q8);
}

// Algorithm 1 with the move_agent() of Algorithm 2.

ProbabilisticAgent::ProbabilisticAgent(const ProbabilisticParameters& parameters, uint32_t seed,
                                       uint32_t stream)
    : random_(seed, stream), memory_(parameters.memory_length), parameters_(parameters) {
  direction_ = static_cast<uint8_t>(random_.next() >> 29);
}

Probability ProbabilisticAgent::probability(uint16_t height) const {
  const uint16_t k_q8 = parameters_.threshold_q8;
  if (k_q8 == 0) return carries_ ? parameters_.deposit : parameters_.pick_up;
  return carries_ ? response_deposit(height, k_q8) : response_pick_up(height, k_q8);
}

GridAction ProbabilisticAgent::tick(const GridInput& input) {
  const uint16_t height = input.height;
  const uint32_t chances = random_.next();  // 16 bits for sensing, 16 for the operation
  if (input.arrived && bernoulli(chances & 0xFFFFU, parameters_.sense)) memory_.add(height);

  // Chance and condition are joined without branches: half of them would be guessed wrong.
  const bool wants = carries_ ? memory_.is_below(height) : memory_.is_above(height);
  GridOperation operation = GridOperation::kNone;
  if (static_cast<unsigned>(wants) &
      static_cast<unsigned>(bernoulli(chances >> 16, probability(height)))) {
    carries_ = !carries_;
    operation = carries_ ? GridOperation::kPickUp : GridOperation::kDeposit;
  }

  const uint32_t step = random_.next();  // 16 bits for the choice, 3 for the direction
  const uint8_t turns = bernoulli(step & 0xFFFFU, parameters_.turn) ? 0xFFU : 0U;
  direction_ = static_cast<uint8_t>(direction_ ^ ((direction_ ^ (step >> 29)) & turns));
  return {operation, direction_};
}

// Chromosomes: validity, random ones, fitness.

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

// Algorithms 3 and 4, the agent's part.

MemeticAgent::MemeticAgent(const MemeticParameters& parameters, uint32_t seed, uint32_t stream)
    : random_(seed, stream), memory_(parameters.memory_length), parameters_(parameters) {
  for (uint8_t i = 0; i < kMaxChromosomes; ++i) chromosomes_[i] = random_chromosome(random_);
}

GridAction MemeticAgent::tick(const GridInput& input) {
  if (input.arrived && bernoulli(random_.next() & 0xFFFFU, parameters_.sense)) {
    memory_.add(input.height);
  }
  const uint8_t gene = chromosomes_[current_].genes[gene_];
  GridAction action = {GridOperation::kNone, kGridStay};
  if (gene < kGridDirections) {
    action.direction = gene;
  } else {
    if (parameters_.fitness_base == FitnessBase::kAttempted) ++fitness_[current_].operations;
    action.operation = gene == kGenePickUp ? pick_up(input.height) : deposit(input.height);
  }
  advance();
  return action;
}

GridOperation MemeticAgent::pick_up(uint16_t height) {
  if (carries_ || !memory_.is_above(height)) return GridOperation::kNone;
  carries_ = true;
  taken_from_ = static_cast<uint16_t>(height - 1);
  Fitness& fitness = fitness_[current_];
  if (parameters_.fitness_base == FitnessBase::kExecuted) ++fitness.operations;
  ++fitness.positive;
  return GridOperation::kPickUp;
}

GridOperation MemeticAgent::deposit(uint16_t height) {
  if (!carries_ || !memory_.is_below(height)) return GridOperation::kNone;
  carries_ = false;
  const uint16_t left = static_cast<uint16_t>(height + 1);
  const uint16_t difference = left > taken_from_ ? static_cast<uint16_t>(left - taken_from_)
                                                 : static_cast<uint16_t>(taken_from_ - left);
  Fitness& fitness = fitness_[current_];
  if (parameters_.fitness_base == FitnessBase::kExecuted) ++fitness.operations;
  if (difference > 1) ++fitness.positive;
  return GridOperation::kDeposit;
}

void MemeticAgent::advance() {
  if (++gene_ < kGenes) return;
  gene_ = 0;
  if (++repetition_ < parameters_.repetitions) return;
  repetition_ = 0;
  if (++current_ < parameters_.chromosomes) return;
  current_ = 0;
  if (parameters_.selects_itself) select();
}

void MemeticAgent::select() {
  for (uint8_t i = 0; i < parameters_.chromosomes; ++i) {
    if (fitness_[i].below(parameters_.threshold)) chromosomes_[i] = random_chromosome(random_);
    fitness_[i] = Fitness();
  }
}

void MemeticAgent::renew() {
  chromosomes_[0] = random_chromosome(random_);
  keep();
}

// The patient agent and the forager.

namespace {

constexpr uint8_t kDownhillTurnFactor = 8;  // times as many turns while the height gets worse

constexpr int32_t to_q16(uint16_t height) {
  return static_cast<int32_t>(height) << 16;  // fits: heights end at kMaxStackHeight
}

}  // namespace

ForagingAgent::ForagingAgent(const ForagingParameters& parameters, uint32_t seed, uint32_t stream)
    : random_(seed, stream), parameters_(parameters) {
  const int32_t dead_band_q16 = static_cast<int32_t>(parameters.dead_band_q8) << 8;
  patience_slope_q16_ = parameters.patience == 0 ? 0 : dead_band_q16 / parameters.patience;
  direction_ = static_cast<uint8_t>(random_.next() >> 29);
}

void ForagingAgent::sense(int32_t height_q16) {
  // The mean of all samples at first, an exponential average later.
  if (samples_ < parameters_.averaging) ++samples_;
  average_q16_ += (height_q16 - average_q16_) / static_cast<int32_t>(samples_);
}

/// How far from the average a cell must be now.
int32_t ForagingAgent::claim_q16() const {
  const int32_t waited = waited_;
  int32_t claim = static_cast<int32_t>(parameters_.dead_band_q8) << 8;
  const int32_t patience = parameters_.patience;
  if (patience != 0 && waited > patience) {
    claim = waited < 2 * patience ? patience_slope_q16_ * (2 * patience - waited) : 0;
  }
  const int32_t hold_out = parameters_.hold_out;
  if (waited < hold_out) claim += hold_out_slope_q16_[carries_ ? 1 : 0] * (hold_out - waited);
  return claim;
}

GridOperation ForagingAgent::operate(uint16_t height) {
  if (waited_ != UINT16_MAX) ++waited_;
  if (samples_ < kMinSamples && samples_ < parameters_.averaging) return GridOperation::kNone;
  const int32_t above_q16 = to_q16(height) - average_q16_;
  const int32_t distance_q16 = carries_ ? -above_q16 : above_q16;
  if (distance_q16 <= claim_q16()) return GridOperation::kNone;

  const int32_t beyond_q16 = distance_q16 - (static_cast<int32_t>(parameters_.dead_band_q8) << 8);
  if (parameters_.hold_out != 0) {
    hold_out_slope_q16_[carries_ ? 1 : 0] =
        beyond_q16 > 0 ? beyond_q16 / static_cast<int32_t>(parameters_.hold_out) : 0;
  }
  waited_ = 0;
  carries_ = !carries_;
  return carries_ ? GridOperation::kPickUp : GridOperation::kDeposit;
}

Probability ForagingAgent::turn_probability(uint16_t height) const {
  if (!parameters_.follows_slope || height == last_height_) return parameters_.turn;
  const bool better = carries_ ? height < last_height_ : height > last_height_;
  return better ? 0 : parameters_.turn * kDownhillTurnFactor;
}

uint8_t ForagingAgent::step(const GridInput& input, GridOperation operation) {
  if (parameters_.turns_back && operation != GridOperation::kNone) {
    return static_cast<uint8_t>((direction_ + 4U) & 7U);
  }
  const uint32_t draw = random_.next();  // 16 bits for the choice, 3 for the direction
  if (!input.arrived || bernoulli(draw & 0xFFFFU, turn_probability(input.height))) {
    return static_cast<uint8_t>(draw >> 29);
  }
  return direction_;
}

GridAction ForagingAgent::tick(const GridInput& input) {
  if (input.arrived && bernoulli(random_.next() & 0xFFFFU, parameters_.sense)) {
    sense(to_q16(input.height));
  }
  const GridOperation operation = operate(input.height);
  direction_ = step(input, operation);
  last_height_ = input.height;
  return {operation, direction_};
}

}  // namespace screed
