// Algorithms 3 and 4 of the thesis: agents that execute sequences of actions and keep the fit ones.
// Variant 1: one chromosome an agent, executed five times; then an oracle outside the swarm lets
// the fittest agent keep its own and gives all others new ones. Variant 2: five chromosomes an
// agent, executed in turn; those whose fitness is below a threshold are replaced.
#pragma once

#include <stdint.h>

#include "host_sim/grid/agents/chromosome.h"
#include "host_sim/grid/agents/grid_types.h"
#include "host_sim/grid/agents/height_memory.h"

namespace screed {

/// Which operations the fitness is counted over.
enum class FitnessBase : uint8_t {
  kExecuted = 0,   ///< those that changed the terrain
  kAttempted = 1,  ///< every pick-up and deposit gene that was reached
};

struct MemeticParameters {
  Probability sense;  ///< of sampling the height on arrival in a cell
  uint8_t memory_length;
  uint8_t chromosomes;  ///< an agent, 1..MemeticAgent::kMaxChromosomes
  uint8_t repetitions;  ///< executions of a chromosome in a row, 1..100
  bool selects_itself;  ///< variant 2: below `threshold` is replaced; variant 1: left to the oracle
  Probability threshold;
  FitnessBase fitness_base;
};

class MemeticAgent {
 public:
  static constexpr uint8_t kMaxChromosomes = 5;

  MemeticAgent(const MemeticParameters& parameters, uint32_t seed, uint32_t stream);

  /// One cycle: sense, then one gene. A gene whose condition does not hold does nothing.
  GridAction tick(const GridInput& input);

  bool carries() const { return carries_; }

  /// Cycles from one selection to the next.
  static uint16_t period(const MemeticParameters& parameters) {
    return static_cast<uint16_t>(static_cast<uint16_t>(parameters.chromosomes) *
                                 parameters.repetitions * kGenes);
  }
  /// Variant 1, at the end of a period: the fitness of the only chromosome.
  const Fitness& fitness() const { return fitness_[0]; }
  const Chromosome& chromosome(uint8_t index) const { return chromosomes_[index]; }
  /// Variant 1, the oracle's verdict at the end of a period: a new chromosome, or the old one with
  /// its count of operations begun anew.
  void renew();
  void keep() { fitness_[0] = Fitness(); }

 private:
  GridOperation pick_up(uint16_t height);
  GridOperation deposit(uint16_t height);
  void advance();
  void select();

  GridRandom random_;
  HeightMemory memory_;
  MemeticParameters parameters_;
  Chromosome chromosomes_[kMaxChromosomes];
  Fitness fitness_[kMaxChromosomes];
  uint16_t taken_from_ = 0;  ///< height left behind by the last pick-up
  uint8_t current_ = 0;
  uint8_t repetition_ = 0;
  uint8_t gene_ = 0;
  bool carries_ = false;
};

}  // namespace screed
