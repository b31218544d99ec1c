// The agents of the grid world alone: each rule of Algorithms 1 to 4, and of ours, without a world.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <vector>

#include "host_sim/grid/grid_agents.h"

namespace screed::testing {
namespace {

/// Chi-square over expected counts. For n >= 5 degrees of freedom, n + 6 sqrt(n) is beyond 99.999
/// %.
double chi_square(const std::vector<double>& seen, const std::vector<double>& expected) {
  double sum = 0.0;
  for (size_t i = 0; i < seen.size(); ++i) {
    sum += (seen[i] - expected[i]) * (seen[i] - expected[i]) / expected[i];
  }
  return sum;
}

TEST(GridRandom, IsTheGeneratorOfItsAuthor) {
  // SFC32 written anew from C. Doty-Humphrey's definition, 15 rounds of warming up.
  uint32_t a = 7;
  uint32_t b = 9;
  uint32_t c = 0x9E3779B9U;
  uint32_t counter = 1;
  const auto reference = [&] {
    const uint32_t result = a + b + counter++;
    a = b ^ (b >> 9);
    b = c + (c << 3);
    c = ((c << 21) | (c >> 11)) + result;
    return result;
  };
  for (int i = 0; i < 15; ++i) reference();
  GridRandom random(7, 9);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(random.next(), reference());
}

TEST(GridRandom, NeighbouringSeedsAndStreamsAreUnrelated) {
  for (const auto& [seed, stream] : {std::pair{1U, 0U}, {0U, 1U}, {2U, 0U}, {1U, 1U}}) {
    GridRandom one(0, 0);
    GridRandom other(seed, stream);
    int equal_bits = 0;
    for (int i = 0; i < 1000; ++i) equal_bits += 32 - __builtin_popcount(one.next() ^ other.next());
    EXPECT_NEAR(equal_bits, 16000, 6 * 90);  // deviation sqrt(32000) / 2 = 89
  }
}

TEST(GridRandom, BelowIsUniform) {
  GridRandom random(3, 1);
  std::vector<double> seen(13, 0.0);
  for (int i = 0; i < 130'000; ++i) ++seen[random.below(13)];
  EXPECT_LT(chi_square(seen, std::vector<double>(13, 10'000.0)), 12 + 6 * std::sqrt(12.0));
}

TEST(HeightMemory, ComparesWithTheMeanOfTheLastSamples) {
  HeightMemory memory(3);
  EXPECT_FALSE(memory.is_above(9));  // no sample yet: nothing is above or below
  EXPECT_FALSE(memory.is_below(0));
  for (const int height : {100, 6, 7, 7})
    memory.add(static_cast<uint16_t>(height));  // the 100 is forgotten
  EXPECT_EQ(memory.sum(), 20U);
  EXPECT_EQ(memory.count(), 3);
  EXPECT_TRUE(memory.is_above(7));  // mean 6.67
  EXPECT_FALSE(memory.is_below(7));
  EXPECT_TRUE(memory.is_below(6));
  EXPECT_FALSE(memory.is_above(6));
  for (int i = 0; i < 3; ++i) memory.add(7);
  EXPECT_FALSE(memory.is_above(7));  // exactly the mean is neither
  EXPECT_FALSE(memory.is_below(7));
}

TEST(HeightMemory, HoldsEightOfTheHighestStacks) {
  HeightMemory memory;
  for (int i = 0; i < 20; ++i) memory.add(kMaxStackHeight);
  EXPECT_EQ(memory.sum(), 8U * kMaxStackHeight);
  EXPECT_TRUE(memory.is_below(kMaxStackHeight - 1));
  EXPECT_FALSE(memory.is_above(kMaxStackHeight));
}

TEST(ResponseCurve, IsTheFormulaOfTheThesis) {
  for (const double k : {0.5, 3.0, 6.0, 10.0, 255.0}) {
    for (const int height : {0, 1, 2, 6, 13, 100, 255}) {
      const auto k_q8 = static_cast<uint16_t>(k * 256.0);
      const double pick_up = std::pow(height / (k + height), 2.0);
      const double deposit = std::pow(k / (k + height), 2.0);
      EXPECT_NEAR(response_pick_up(static_cast<uint16_t>(height), k_q8) / 65536.0, pick_up,
                  3.0 / 65536.0);
      EXPECT_NEAR(response_deposit(static_cast<uint16_t>(height), k_q8) / 65536.0, deposit,
                  3.0 / 65536.0);
    }
  }
  EXPECT_NEAR(response_pick_up(kMaxStackHeight, 256) / 65536.0, 1.0, 1.0 / 256.0);
  EXPECT_NEAR(response_deposit(kMaxStackHeight, 65535) / 65536.0, 0.0, 1.0 / 256.0);
}

constexpr ProbabilisticParameters kAlgorithm1 = {655, 19661, 19661, 49152, 0, 8};

/// Lets an agent sense the heights of its way until it has eight samples of that height.
template <class Agent>
void teach(Agent& agent, uint16_t height) {
  for (int i = 0; i < 20'000; ++i) agent.tick({height, true});
}

TEST(ProbabilisticAgent, DoesNothingBeforeItsFirstSample) {
  ProbabilisticParameters parameters = kAlgorithm1;
  parameters.sense = 0;
  parameters.pick_up = parameters.deposit = kAlways;
  ProbabilisticAgent agent(parameters, 1, 1);
  for (int i = 0; i < 1000; ++i) {
    EXPECT_EQ(agent.tick({static_cast<uint16_t>(i % 20), true}).operation, GridOperation::kNone);
  }
}

TEST(ProbabilisticAgent, SensesOnlyOnArrival) {
  ProbabilisticParameters parameters = kAlgorithm1;
  parameters.sense = parameters.pick_up = kAlways;
  ProbabilisticAgent agent(parameters, 1, 1);
  EXPECT_EQ(agent.tick({9, false}).operation, GridOperation::kNone);
  EXPECT_EQ(agent.tick({5, true}).operation, GridOperation::kNone);     // mean 5
  EXPECT_EQ(agent.tick({6, false}).operation, GridOperation::kPickUp);  // mean 5 still
}

TEST(ProbabilisticAgent, PicksUpAboveAndDepositsBelowTheMean) {
  ProbabilisticParameters parameters = kAlgorithm1;
  parameters.pick_up = parameters.deposit = kAlways;
  ProbabilisticAgent agent(parameters, 1, 1);
  teach(agent, 6);
  EXPECT_EQ(agent.tick({5, false}).operation, GridOperation::kNone);  // carries nothing
  EXPECT_EQ(agent.tick({6, false}).operation, GridOperation::kNone);
  EXPECT_EQ(agent.tick({7, false}).operation, GridOperation::kPickUp);
  EXPECT_TRUE(agent.carries());
  EXPECT_EQ(agent.tick({8, false}).operation, GridOperation::kNone);  // one unit at a time
  EXPECT_EQ(agent.tick({6, false}).operation, GridOperation::kNone);
  EXPECT_EQ(agent.tick({5, false}).operation, GridOperation::kDeposit);
  EXPECT_FALSE(agent.carries());
}

/// How often an agent acts, of many chances: to pick up at height 9, to deposit at height 3.
std::array<double, 2> shares_of_chances(ProbabilisticAgent& agent) {
  std::array<int, 2> chances{};
  std::array<int, 2> done{};
  for (int i = 0; i < 100'000; ++i) {
    const bool carried = agent.carries();
    const uint16_t height = carried ? 3 : 9;
    ++chances[carried ? 1 : 0];
    if (agent.tick({height, false}).operation != GridOperation::kNone) ++done[carried ? 1 : 0];
  }
  return {static_cast<double>(done[0]) / chances[0], static_cast<double>(done[1]) / chances[1]};
}

TEST(ProbabilisticAgent, ActsWithItsProbabilities) {
  ProbabilisticParameters parameters = kAlgorithm1;
  parameters.pick_up = static_cast<Probability>(0.2 * 65536);
  parameters.deposit = static_cast<Probability>(0.7 * 65536);
  ProbabilisticAgent agent(parameters, 1, 1);
  teach(agent, 6);
  const std::array<double, 2> acts = shares_of_chances(agent);
  EXPECT_NEAR(acts[0], 0.2, 0.01);
  EXPECT_NEAR(acts[1], 0.7, 0.015);
}

TEST(ProbabilisticAgent, ThresholdsReplaceTheConstants) {
  ProbabilisticParameters parameters = kAlgorithm1;
  parameters.threshold_q8 = 6 * 256;
  ProbabilisticAgent agent(parameters, 1, 1);
  teach(agent, 6);
  const std::array<double, 2> acts = shares_of_chances(agent);
  EXPECT_NEAR(acts[0], 0.36, 0.01);    // (9 / 15)^2
  EXPECT_NEAR(acts[1], 0.444, 0.012);  // (6 / 9)^2
}

TEST(ProbabilisticAgent, WalksAsAlgorithm2) {
  ProbabilisticAgent agent(kAlgorithm1, 5, 2);
  std::vector<double> seen(8, 0.0);
  int repeats = 0;
  uint8_t last = agent.tick({6, true}).direction;
  constexpr int kSteps = 80'000;
  for (int i = 0; i < kSteps; ++i) {
    const uint8_t direction = agent.tick({6, true}).direction;
    ASSERT_LT(direction, 8);  // never stays
    ++seen[direction];
    repeats += direction == last ? 1 : 0;
    last = direction;
  }
  // A quarter forward, and an eighth of the random steps.
  EXPECT_NEAR(static_cast<double>(repeats) / kSteps, 0.25 + 0.75 / 8.0, 0.01);
  // Repeats correlate the counts: (1 + 1/4) / (1 - 1/4) times the variance.
  EXPECT_LT(chi_square(seen, std::vector<double>(8, kSteps / 8.0)),
            (7 + 6 * std::sqrt(7.0)) * 5 / 3);
}

TEST(Chromosome, ValidityIsThatOfTheThesis) {
  Chromosome chromosome{};
  EXPECT_FALSE(is_valid(chromosome));  // steps only
  chromosome.genes[3] = kGenePickUp;
  EXPECT_FALSE(is_valid(chromosome));
  chromosome.genes[9] = kGeneDeposit;
  EXPECT_TRUE(is_valid(chromosome));
  chromosome.genes[12] = kGenePickUp;
  chromosome.genes[13] = kGeneDeposit;
  EXPECT_FALSE(is_valid(chromosome));  // a pick-up after a deposit
  chromosome.genes[12] = kGeneDeposit;
  chromosome.genes[13] = 0;
  EXPECT_FALSE(is_valid(chromosome));  // two deposits, one pick-up
  chromosome.genes[5] = kGenePickUp;
  EXPECT_TRUE(is_valid(chromosome));
}

/// What the issue of a draw is: the number of pairs, and where the first two operations stand.
std::array<int, 3> shape(const Chromosome& chromosome) {
  std::array<int, 3> shape = {0, -1, -1};
  for (int i = 0; i < kGenes; ++i) {
    if (chromosome.genes[i] < kGenePickUp) continue;
    if (shape[1] < 0) {
      shape[1] = i;
    } else if (shape[2] < 0) {
      shape[2] = i;
    }
    if (chromosome.genes[i] == kGenePickUp) ++shape[0];
  }
  return shape;
}

TEST(Chromosome, DirectDrawHasTheDistributionOfRejection) {
  // The definition: 20 genes of 0..9 until they are valid.
  GridRandom rejecting(11, 0);
  GridRandom direct(12, 0);
  std::map<std::array<int, 3>, std::array<double, 2>> counts;
  constexpr int kDraws = 60'000;
  std::array<double, 10> genes_seen{};
  for (int i = 0; i < kDraws; ++i) {
    Chromosome by_rejection{};
    do {
      for (uint8_t& gene : by_rejection.genes) gene = static_cast<uint8_t>(rejecting.below(10));
    } while (!is_valid(by_rejection));
    ++counts[shape(by_rejection)][0];
    const Chromosome drawn = random_chromosome(direct);
    ASSERT_TRUE(is_valid(drawn));
    ++counts[shape(drawn)][1];
    for (const uint8_t gene : drawn.genes) ++genes_seen[gene];
  }
  // Two samples of equal size, cells of few counts together.
  double sum = 0.0;
  int cells = 0;
  std::array<double, 2> rest{};
  for (const auto& [what, seen] : counts) {
    if (seen[0] + seen[1] < 20.0) {
      rest[0] += seen[0];
      rest[1] += seen[1];
      continue;
    }
    sum += (seen[0] - seen[1]) * (seen[0] - seen[1]) / (seen[0] + seen[1]);
    ++cells;
  }
  sum += (rest[0] - rest[1]) * (rest[0] - rest[1]) / std::max(1.0, rest[0] + rest[1]);
  ASSERT_GT(cells, 200);
  EXPECT_LT(sum, cells + 6 * std::sqrt(2.0 * cells));
  // The exact mean of pairs, of C(20, 2n) 8^(20 - 2n) chromosomes with n pairs.
  double all = 0.0;
  double pairs = 0.0;
  for (int n = 1; n <= 10; ++n) {
    const double count = std::exp(std::lgamma(21) - std::lgamma(2 * n + 1) -
                                  std::lgamma(21 - 2 * n) + (20 - 2 * n) * std::log(8.0));
    all += count;
    pairs += n * count;
  }
  EXPECT_NEAR(genes_seen[kGenePickUp] / kDraws, pairs / all, 0.012);
  EXPECT_EQ(genes_seen[kGenePickUp], genes_seen[kGeneDeposit]);
  const double steps = (20.0 - 2.0 * pairs / all) / 8.0;
  for (int direction = 0; direction < 8; ++direction) {
    EXPECT_NEAR(genes_seen[static_cast<size_t>(direction)] / kDraws, steps, 0.035);
  }
}

TEST(Fitness, ComparesQuotientsExactly) {
  EXPECT_TRUE((Fitness{2, 3}.better_than(Fitness{1, 2})));
  EXPECT_FALSE((Fitness{2, 4}.better_than(Fitness{1, 2})));
  EXPECT_FALSE((Fitness{1, 2}.better_than(Fitness{2, 4})));
  EXPECT_TRUE((Fitness{1, 9}.better_than(Fitness{0, 0})));
  EXPECT_FALSE((Fitness{0, 0}.better_than(Fitness{0, 5})));
  EXPECT_TRUE((Fitness{0, 0}.below(kAlways)));  // nothing done is worth nothing
  EXPECT_FALSE((Fitness{2, 2}.below(kAlways)));
  EXPECT_TRUE((Fitness{65534, 65535}.below(kAlways)));
  EXPECT_FALSE((Fitness{1, 2}.below(kAlways / 2)));
}

constexpr MemeticParameters kVariant1 = {kAlways, 8, 1, 5, false, kAlways, FitnessBase::kExecuted};
constexpr MemeticParameters kVariant2 = {kAlways, 8, 5, 1, true, kAlways, FitnessBase::kExecuted};

TEST(MemeticAgent, ExecutesItsChromosomeGeneByGene) {
  MemeticAgent agent(kVariant1, 4, 1);
  const Chromosome chromosome = agent.chromosome(0);
  for (int repetition = 0; repetition < 5; ++repetition) {
    for (const uint8_t gene : chromosome.genes) {
      const GridAction action = agent.tick({6, true});  // always the mean: operations fail silently
      EXPECT_EQ(action.operation, GridOperation::kNone);
      EXPECT_EQ(action.direction, gene < 8 ? gene : kGridStay);
    }
  }
  EXPECT_EQ(MemeticAgent::period(kVariant1), 100);
  EXPECT_EQ(MemeticAgent::period(kVariant2), 100);
}

/// Plays one chromosome of variant 1: heights that every pick-up and every deposit gene meets.
MemeticAgent played(MemeticParameters parameters, uint16_t at_pick_up, uint16_t at_deposit) {
  parameters.repetitions = 2;  // the second would start anew; the test stops before
  MemeticAgent agent(parameters, 4, 1);
  const Chromosome chromosome = agent.chromosome(0);
  bool first = true;
  for (const uint8_t gene : chromosome.genes) {
    const uint16_t height = gene == kGenePickUp    ? at_pick_up
                            : gene == kGeneDeposit ? at_deposit
                                                   : 6;
    // The first tick alone senses: mean 6.
    agent.tick({first ? uint16_t{6} : height, first});
    first = false;
  }
  return agent;
}

TEST(MemeticAgent, FitnessCountsPositiveChanges) {
  MemeticParameters parameters = kVariant1;
  ASSERT_LT(MemeticAgent(kVariant1, 4, 1).chromosome(0).genes[0], kGenePickUp);  // mean first
  // 9 -> 8 and 3 -> 4: both positive.
  EXPECT_EQ(played(parameters, 9, 3).fitness().positive, 2);
  EXPECT_EQ(played(parameters, 9, 3).fitness().operations, 2);
  // 7 -> 6 and 5 -> 6: the deposit changes nothing, |6 - 6| <= 1.
  EXPECT_EQ(played(parameters, 7, 5).fitness().positive, 1);
  EXPECT_EQ(played(parameters, 7, 5).fitness().operations, 2);
  // 8 -> 7 and 5 -> 6: |6 - 7| = 1 is not more than 1.
  EXPECT_EQ(played(parameters, 8, 5).fitness().positive, 1);
  // 9 -> 8, 5 -> 6: 2 is.
  EXPECT_EQ(played(parameters, 9, 5).fitness().positive, 2);
  // Nothing above the mean: nothing is executed, both were attempted.
  EXPECT_EQ(played(parameters, 6, 3).fitness().operations, 0);
  parameters.fitness_base = FitnessBase::kAttempted;
  EXPECT_GE(played(parameters, 6, 3).fitness().operations, 2);
  EXPECT_EQ(played(parameters, 6, 3).fitness().positive, 0);
}

TEST(MemeticAgent, SecondVariantKeepsTheFitAndReplacesTheOthers) {
  MemeticAgent agent(kVariant2, 4, 1);
  std::array<Chromosome, 5> before{};
  for (uint8_t i = 0; i < 5; ++i) before[i] = agent.chromosome(i);
  agent.tick({6, true});
  int position = 1;
  // Chromosomes 0 and 3 meet peaks and valleys, the others level ground.
  for (; position < 100; ++position) {
    const int index = position / kGenes;
    const uint8_t gene = before[static_cast<size_t>(index)].genes[position % kGenes];
    const bool rough = index == 0 || index == 3;
    const uint16_t height = !rough ? 6 : gene == kGenePickUp ? 12 : gene == kGeneDeposit ? 1 : 6;
    agent.tick({height, false});
  }
  for (uint8_t i = 0; i < 5; ++i) {
    const bool kept = std::equal(std::begin(before[i].genes), std::end(before[i].genes),
                                 std::begin(agent.chromosome(i).genes));
    EXPECT_EQ(kept, i == 0 || i == 3) << static_cast<int>(i);
  }
}

constexpr ForagingParameters kPatient = {kAlways, 1024, 230, 100, 0, 3277, false, false};
constexpr ForagingParameters kForager = {kAlways, 1024, 205, 100, 200, 3277, true, true};

TEST(ForagingAgent, AveragesWhatItSees) {
  ForagingAgent agent(kPatient, 1, 1);
  for (int i = 0; i < 1000; ++i) {
    // 6 and 7 by turns stay within the dead band.
    EXPECT_EQ(agent.tick({static_cast<uint16_t>(6 + i % 2), true}).operation, GridOperation::kNone)
        << i;
    if (i == 99) break;  // before patience ends
  }
  EXPECT_NEAR(agent.average_q16() / 65536.0, 6.5, 0.01);
}

TEST(ForagingAgent, AveragesTheHighestStacksWithoutOverflow) {
  ForagingAgent agent(kForager, 1, 1);
  for (int i = 0; i < 3000; ++i) {
    agent.tick({static_cast<uint16_t>(i % 2 == 0 ? 0 : kMaxStackHeight), true});
  }
  EXPECT_NEAR(agent.average_q16() / 65536.0, kMaxStackHeight / 2.0, 40.0);
}

TEST(ForagingAgent, LeavesTheDeadBandAloneUntilItsPatienceEnds) {
  ForagingAgent agent(kPatient, 1, 1);
  for (int i = 0; i < 50; ++i) agent.tick({6, true});
  // 0.9 above 6 begins at 7.
  EXPECT_EQ(agent.tick({7, false}).operation, GridOperation::kPickUp);
  // 5 is 1 below: far enough. 6 is not below at all, however long it takes.
  for (int i = 0; i < 500; ++i) EXPECT_EQ(agent.tick({6, false}).operation, GridOperation::kNone);
  EXPECT_EQ(agent.tick({5, false}).operation, GridOperation::kDeposit);

  ForagingAgent half(kPatient, 1, 1);
  for (int i = 0; i < 60; ++i) half.tick({static_cast<uint16_t>(6 + i % 2), true});
  int waited = 60;
  while (half.tick({7, false}).operation == GridOperation::kNone) ++waited;
  // 7 is 0.5 above 6.5: it waits until the dead band of 0.9 has shrunk to that, 4/9 of the way from
  // 100 to 200 cycles.
  EXPECT_NEAR(waited, 144, 3);
}

TEST(ForagingAgent, WithoutPatienceTheDeadBandStays) {
  ForagingParameters parameters = kPatient;
  parameters.patience = 0;
  ForagingAgent agent(parameters, 1, 1);
  for (int i = 0; i < 60; ++i) agent.tick({static_cast<uint16_t>(6 + i % 2), true});
  for (int i = 0; i < 200'000; ++i) {
    ASSERT_EQ(agent.tick({7, false}).operation, GridOperation::kNone);
  }
}

TEST(ForagingAgent, HoldsOutForAPlaceLikeTheLast) {
  ForagingParameters parameters = kForager;
  parameters.patience = 0;
  ForagingAgent agent(parameters, 1, 1);
  for (int i = 0; i < 60; ++i) agent.tick({6, true});
  EXPECT_EQ(agent.tick({12, false}).operation, GridOperation::kPickUp);  // claim: 6 above
  EXPECT_EQ(agent.tick({2, false}).operation, GridOperation::kDeposit);
  // 5.2 beyond the dead band of 0.8, given up over 200 cycles: 9 is 3 above and is taken when
  // 5.2 (1 - t / 200) < 2.2.
  int waited = 1;
  while (agent.tick({9, false}).operation == GridOperation::kNone) ++waited;
  EXPECT_NEAR(waited, 200.0 * (1.0 - 2.2 / 5.2), 3.0);
}

TEST(ForagingAgent, TurnsBackAfterAnOperation) {
  ForagingAgent agent(kForager, 1, 1);
  uint8_t direction = 0;
  for (int i = 0; i < 60; ++i) direction = agent.tick({6, true}).direction;
  const GridAction action = agent.tick({9, true});
  ASSERT_EQ(action.operation, GridOperation::kPickUp);
  EXPECT_EQ(action.direction, (direction + 4) % 8);
}

TEST(ForagingAgent, KeepsOnWhileTheHeightImproves) {
  ForagingParameters parameters = kForager;
  parameters.sense = 0;  // never acts
  const auto turns = [&](int slope) {
    ForagingAgent agent(parameters, 1, 1);
    uint8_t last = agent.tick({10000, true}).direction;
    int count = 0;
    for (int i = 1; i <= 4000; ++i) {
      const uint8_t direction =
          agent.tick({static_cast<uint16_t>(10000 + slope * i), true}).direction;
      count += direction != last ? 1 : 0;
      last = direction;
    }
    return count;
  };
  EXPECT_EQ(turns(1), 0);  // empty and uphill
  EXPECT_NEAR(turns(0), 4000 * 0.05 * 7 / 8, 60);
  EXPECT_NEAR(turns(-1), 4000 * 0.4 * 7 / 8, 150);
}

TEST(ForagingAgent, BlockedItTakesAnotherDirection) {
  ForagingParameters parameters = kForager;
  parameters.turn = 0;
  ForagingAgent agent(parameters, 1, 1);
  std::vector<double> seen(8, 0.0);
  for (int i = 0; i < 8000; ++i) ++seen[agent.tick({6, false}).direction];
  EXPECT_LT(chi_square(seen, std::vector<double>(8, 1000.0)), 7 + 6 * std::sqrt(7.0));
}

}  // namespace
}  // namespace screed::testing
