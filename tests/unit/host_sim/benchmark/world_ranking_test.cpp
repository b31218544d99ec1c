// Rankings of made-up runs in two worlds.
#include "host_sim/benchmark/world_ranking.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "host_sim/benchmark/benchmark_file.h"

namespace screed {
namespace {

constexpr int kSeeds = 4;

CampaignPlan plan(const std::vector<std::string>& worlds) {
  CampaignPlan plan;
  plan.settings.seeds = {1, 2, 3, 4};
  plan.factors.push_back({kWorldFactor, {}, {}, ""});
  for (const char* factor : kCourseFactors) plan.factors.push_back({factor, {}, {}, ""});
  plan.factors.push_back({kEntryFactor, {}, {}, ""});
  for (const std::string& world : worlds) {
    for (const char* soil : {"gravel", "sand"}) {
      for (const char* entry : {"walk", "spin", "strokes"})
        plan.cells.push_back({world, "small", "rough", soil, "one", "fixes", entry});
    }
  }
  plan.durations_s.assign(plan.cells.size(), 1800.0);
  return plan;
}

/// Changes of relief by cell, the same on all beds.
ValueTable runs(const std::vector<double>& changes) {
  ValueTable table;
  for (const double change : changes) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      table.add_row();
      table.set("terrain_before.relief_m", 0.01 * (seed + 1));
      table.set("terrain_after.relief_m", 0.01 * (seed + 1) * (1.0 + change));
    }
  }
  return table;
}

TEST(WorldRanking, ComparesTheOrderOfEachCourseAndOfAll) {
  // On gravel the other world has the same order, on sand the opposite one.
  const auto rankings =
      rank_worlds(plan({"physics", "stand_in"}), runs({-0.1, -0.2, -0.5, -0.01, -0.02, -0.03,  //
                                                       -0.1, -0.3, -0.4, -0.03, -0.02, -0.01}));
  ASSERT_EQ(rankings.size(), 3U);
  EXPECT_EQ(rankings[0].course,
            (std::vector<std::string>{"small", "rough", "gravel", "one", "fixes"}));
  EXPECT_EQ(rankings[0].reference, "physics");
  EXPECT_EQ(rankings[0].other, "stand_in");
  EXPECT_EQ(rankings[0].tau.mean, 1.0);
  EXPECT_EQ(rankings[0].tau.count, static_cast<std::size_t>(kSeeds));
  EXPECT_EQ(rankings[0].tau.interval.low, 1.0);
  EXPECT_EQ(rankings[1].tau.mean, -1.0);
  ASSERT_EQ(rankings[0].entries.size(), 3U);
  EXPECT_EQ(rankings[0].entries[1].entry, "spin");
  EXPECT_NEAR(rankings[0].entries[1].reference.mean, -0.2, 1e-12);
  EXPECT_NEAR(rankings[0].entries[1].other.mean, -0.3, 1e-12);
  EXPECT_TRUE(rankings[2].course.empty());
  EXPECT_NEAR(rankings[2].tau.mean, 9.0 / 15.0, 1e-12);  // 12 of 15 pairs agree
}

TEST(WorldRanking, SaysHowWellTheReferenceRepeatsItself) {
  // The same on all beds; what the other world does has no part in it.
  ValueTable table = runs({-0.1, -0.2, -0.5, -0.01, -0.02, -0.03,  //
                           -0.1, -0.3, -0.4, -0.03, -0.02, -0.01});
  EXPECT_NEAR(rank_worlds(plan({"physics", "stand_in"}), table)[0].reference_halves, 1.0, 1e-12);
  // On gravel walk and spin change places on two of four beds. Two of three halves have a bed of
  // each kind, in which the two are alike: the other pairs agree. In the third they stand the other
  // way round: two pairs of three agree.
  const std::vector<double> walk = {-0.1, -0.1, -0.3, -0.3};
  const std::vector<double> spin = {-0.3, -0.3, -0.1, -0.1};
  ValueTable swapped;
  const auto add = [&](double change) {
    swapped.add_row();
    swapped.set("terrain_before.relief_m", 0.01);
    swapped.set("terrain_after.relief_m", 0.01 * (1.0 + change));
  };
  for (int cell = 0; cell < 12; ++cell) {
    for (std::size_t bed = 0; bed < 4; ++bed) {
      add(cell == 0 ? walk[bed] : cell == 1 ? spin[bed] : cell == 2 ? -0.5 : -0.01 * cell);
    }
  }
  const auto rankings = rank_worlds(plan({"physics", "stand_in"}), swapped);
  EXPECT_NEAR(rankings[0].reference_halves, (2.0 * 1.0 + 1.0 / 3.0) / 3.0, 0.05);
  EXPECT_NEAR(rankings[1].reference_halves, 1.0, 1e-12);
  // Entries that are all alike order nothing.
  const ValueTable alike = runs(std::vector<double>(12, -0.1));
  EXPECT_TRUE(std::isnan(rank_worlds(plan({"physics", "stand_in"}), alike)[0].reference_halves));
}

TEST(WorldRanking, LeavesOutBedsWithoutAValue) {
  ValueTable table = runs({-0.1, -0.2, -0.5, -0.01, -0.02, -0.03,  //
                           -0.1, -0.3, -0.4, -0.01, -0.02, -0.03});
  table.set("terrain_after.relief_m", nullptr);  // of the last run
  const auto rankings = rank_worlds(plan({"physics", "stand_in"}), table);
  EXPECT_EQ(rankings[0].tau.count, 4U);
  EXPECT_EQ(rankings[1].tau.count, 3U);
  EXPECT_EQ(rankings[2].tau.count, 3U);
}

TEST(WorldRanking, OfOneWorldThereIsNone) {
  EXPECT_TRUE(rank_worlds(plan({"physics"}), runs(std::vector<double>(6, -0.1))).empty());
  CampaignPlan without = plan({"physics"});
  without.factors.erase(without.factors.begin());
  for (auto& cell : without.cells) cell.erase(cell.begin());
  EXPECT_TRUE(rank_worlds(without, runs(std::vector<double>(6, -0.1))).empty());
}

}  // namespace
}  // namespace screed
