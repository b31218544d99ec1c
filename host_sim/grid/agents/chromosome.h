// The action sequences of the memetic algorithms (thesis 4.2.3): 20 genes, each a step in one of 8
// directions, a pick-up or a deposit.
#pragma once

#include <stdint.h>

#include "host_sim/grid/agents/grid_random.h"

namespace screed {

constexpr uint8_t kGenes = 20;
constexpr uint8_t kGenePickUp = 8;  ///< genes below are directions
constexpr uint8_t kGeneDeposit = 9;

/// Valid when it has as many pick-ups as deposits, at least one of each, and every pick-up comes
/// before every deposit.
struct Chromosome {
  uint8_t genes[kGenes];
};

bool is_valid(const Chromosome& chromosome);

/// Uniform over all valid chromosomes: what drawing 20 genes from 0..9 until they are valid gives,
/// without the 19 of 20 draws that are thrown away. (Off by at most 2^-26 of a probability.)
Chromosome random_chromosome(GridRandom& random);

/// What a chromosome did while it was executed; its fitness is positive / operations.
struct Fitness {
  uint16_t positive = 0;    ///< operations that flattened the terrain
  uint16_t operations = 0;  ///< operations counted

  /// Exact comparison of the quotients; no operation counts as fitness 0.
  bool better_than(const Fitness& other) const;
  /// Whether the fitness is below threshold / 65536.
  bool below(Probability threshold) const;
};

}  // namespace screed
