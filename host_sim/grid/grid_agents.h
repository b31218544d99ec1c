// The agents of the grid world: what they see and answer (thesis 4.2), and the algorithms. An agent
// must not know the grid: neither its size nor its own place, nor that there are other agents.
//
// A cycle is one tick() of every agent: it receives the height of its cell and whether it has just
// come there, and answers with at most one operation on that cell and at most one step to a
// neighbour. The world carries out the operation first; a step to an occupied cell or out of the
// grid fails, and the next tick says so.
#pragma once

#include <stdint.h>

namespace screed {

/// The highest stack of a cell, units.
constexpr uint16_t kMaxStackHeight = 32767;

enum class GridOperation : uint8_t {
  kNone = 0,
  kPickUp = 1,   ///< take one unit off the cell
  kDeposit = 2,  ///< put the carried unit onto the cell
};

/// Directions are 0..7, counter-clockwise from +x (east) in steps of 45 degrees.
constexpr uint8_t kGridDirections = 8;
constexpr uint8_t kGridStay = 8;

struct GridInput {
  uint16_t height;  ///< of the cell under the agent, 0..kMaxStackHeight
  bool arrived;     ///< the last tick's step succeeded, or this is the first tick
};

struct GridAction {
  GridOperation operation;
  uint8_t direction;  ///< 0..7, or kGridStay
};

/// A probability as Q16: 0 never, 65536 always.
using Probability = uint32_t;
constexpr Probability kAlways = 65536;

// Random numbers of one agent: SFC32 (C. Doty-Humphrey, PractRand 2010). Additions, shifts and a
// rotation of 32 bits: cheap on a microcontroller as well. 32 bits a draw, period at least 2^32.

class GridRandom {
 public:
  /// Every pair of seed and stream gives a sequence of its own.
  GridRandom(uint32_t seed, uint32_t stream) : a_(seed), b_(stream), c_(0x9E3779B9U) {
    for (uint8_t i = 0; i < 15; ++i) next();
  }

  uint32_t next() {
    const uint32_t result = a_ + b_ + counter_++;
    a_ = b_ ^ (b_ >> 9);
    b_ = c_ + (c_ << 3);
    c_ = ((c_ << 21) | (c_ >> 11)) + result;
    return result;
  }

  /// Uniform in 0..count-1; off by at most count / 2^32 of a probability. count in 1..65535.
  uint16_t below(uint16_t count) {
    // The upper half of the product of 32 and 16 bits, built of halves.
    const uint32_t draw = next();
    const uint32_t low = (draw & 0xFFFFU) * count;
    return static_cast<uint16_t>(((draw >> 16) * count + (low >> 16)) >> 16);
  }

 private:
  uint32_t a_;
  uint32_t b_;
  uint32_t c_;
  uint32_t counter_ = 1;
};

/// Whether an event of that probability happens, by 16 random bits.
inline bool bernoulli(uint32_t bits16, Probability probability) {
  return bits16 < probability;
}

// The sparse samples that an agent judges heights by: a FIFO of the last few, whose mean is the
// alpha of Algorithm 1. Comparisons with the mean are exact: h n against the sum, no division.

class HeightMemory {
 public:
  static constexpr uint8_t kMaxLength = 8;

  /// length: samples kept, 1..kMaxLength.
  explicit HeightMemory(uint8_t length = kMaxLength) : length_(length) {}

  /// Forgets the oldest sample when there are `length` already.
  void add(uint16_t height);

  /// No sample yet: nothing is above or below.
  bool empty() const { return count_ == 0; }
  bool is_above(uint16_t height) const { return static_cast<uint32_t>(height) * count_ > sum_; }
  bool is_below(uint16_t height) const { return static_cast<uint32_t>(height) * count_ < sum_; }

  /// Sum and number of the samples kept.
  uint32_t sum() const { return sum_; }
  uint8_t count() const { return count_; }

 private:
  uint32_t sum_ = 0;
  uint16_t samples_[kMaxLength] = {};
  uint8_t length_;
  uint8_t count_ = 0;
  uint8_t oldest_ = 0;  ///< where the next sample goes
};

// The response-threshold curves of thesis 4.2.1 (Deneubourg et al.): the higher a stack, the
// likelier it is picked from, and the less likely put on.

/// (h / (k + h))^2, k = k_q8 / 256 > 0. Right within 3 * 2^-16 for heights below
/// 256, within 2^-7 for all.
Probability response_pick_up(uint16_t height, uint16_t k_q8);

/// (k / (k + h))^2, likewise.
Probability response_deposit(uint16_t height, uint16_t k_q8);

// Algorithm 1 of the thesis: picks up above the sensed mean and deposits below it, each with a
// probability, and walks at random (Algorithm 2). With constant probabilities or with the response
// thresholds of 4.2.1.

struct ProbabilisticParameters {
  Probability sense;      ///< of sampling the height on arrival in a cell
  Probability pick_up;    ///< when the cell is above the mean; unused with a threshold
  Probability deposit;    ///< when the cell is below the mean; unused with a threshold
  Probability turn;       ///< of a step in a random direction; otherwise the last one again
  uint16_t threshold_q8;  ///< k of the response curves in 1/256 unit; 0: the constant probabilities
                          ///< above
  uint8_t memory_length;  ///< samples in the mean, 1..HeightMemory::kMaxLength
};

class ProbabilisticAgent {
 public:
  ProbabilisticAgent(const ProbabilisticParameters& parameters, uint32_t seed, uint32_t stream);

  /// One cycle: sense, then operation and step. Nothing is picked up or deposited before the first
  /// sample.
  GridAction tick(const GridInput& input);

  bool carries() const { return carries_; }

 private:
  /// Of the operation that is next, on a stack of that height.
  Probability probability(uint16_t height) const;

  GridRandom random_;
  HeightMemory memory_;
  ProbabilisticParameters parameters_;
  uint8_t direction_;
  bool carries_ = false;
};

// The action sequences of the memetic algorithms (thesis 4.2.3): 20 genes, each a step in one of 8
// directions, a pick-up or a deposit.

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

// Algorithms 3 and 4 of the thesis: agents that execute sequences of actions and keep the fit ones.
// Variant 1: one chromosome an agent, executed five times; then an oracle outside the swarm lets
// the fittest agent keep its own and gives all others new ones. Variant 2: five chromosomes an
// agent, executed in turn; those whose fitness is below a threshold are replaced.

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

// Better than Algorithm 1 with the same information: height of the cell, whether the last step
// succeeded, no map, no communication. Two algorithms are settings of this agent
// (docs/grid-world.md has the figures):
//   patient  a running average in place of eight sparse samples, straight walks, and a dead band
//            around the average within which nothing is moved, unless it has waited too long
//   forager  turns back after every operation, runs and tumbles along the slope, and holds out for
//            a place as high or low as the last one

struct ForagingParameters {
  Probability sense;      ///< of sampling the height on arrival in a cell
  uint16_t averaging;     ///< samples that the average forgets after, 1..32767
  uint16_t dead_band_q8;  ///< least distance from the average of a cell worth an operation, 1/256
                          ///< unit
  uint16_t patience;      ///< cycles without an operation before the dead band shrinks, gone after
                          ///< twice as many; 0: it never shrinks
  uint16_t hold_out;      ///< cycles over which the agent lowers its claim from the last place's
                          ///< distance to the dead band; 0: takes the first
  Probability turn;       ///< of a new direction in a cycle; a blocked agent always takes one
  bool follows_slope;     ///< never turns while the height improves, eight times as often while it
                       ///< gets worse (uphill is better for empty agents, downhill for loaded ones)
  bool turns_back;  ///< after an operation the way it came, in the same cycle
};

class ForagingAgent {
 public:
  /// Samples before the first operation.
  static constexpr uint16_t kMinSamples = 8;

  ForagingAgent(const ForagingParameters& parameters, uint32_t seed, uint32_t stream);

  /// One cycle: sense, operation, step.
  GridAction tick(const GridInput& input);

  bool carries() const { return carries_; }
  /// The average height, Q16.
  int32_t average_q16() const { return average_q16_; }

 private:
  void sense(int32_t height_q16);
  int32_t claim_q16() const;
  GridOperation operate(uint16_t height);
  uint8_t step(const GridInput& input, GridOperation operation);
  Probability turn_probability(uint16_t height) const;

  GridRandom random_;
  ForagingParameters parameters_;
  int32_t average_q16_ = 0;
  int32_t patience_slope_q16_;              ///< dead band given up in a cycle, after patience
  int32_t hold_out_slope_q16_[2] = {0, 0};  ///< claim lowered in a cycle; empty, loaded
  uint16_t samples_ = 0;
  uint16_t waited_ = 0;  ///< cycles since the last operation
  uint16_t last_height_ = 0;
  uint8_t direction_;
  bool carries_ = false;
};

}  // namespace screed
