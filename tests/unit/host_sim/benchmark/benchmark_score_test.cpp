// Scores of made-up runs whose figures are known, and rankings of their entries in two worlds.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "host_sim/benchmark/benchmark_file.h"
#include "host_sim/benchmark/benchmark_score.h"

namespace screed {
namespace {

/// Two courses with two entries on three beds each, half an hour long.
CampaignPlan plan() {
  CampaignPlan plan;
  plan.settings.seeds = {1, 2, 3};
  for (const char* factor : kCourseFactors) plan.factors.push_back({factor, {}, {}, ""});
  plan.factors.push_back({kEntryFactor, {}, {}, ""});
  for (const char* bed : {"smooth", "rough"}) {
    for (const char* entry : {"walk", "spin"})
      plan.cells.push_back({"small", bed, "gravel", "one", "fixes", entry});
  }
  plan.durations_s.assign(4, 1800.0);
  return plan;
}

/// The walk leaves the ground as it is; the spin takes 10, 20 and 30 % of its height about level,
/// of twice as much on the second course.
ValueTable runs() {
  ValueTable table;
  for (int run = 0; run < 12; ++run) {
    const bool spin = run / 3 % 2 == 1;
    const double share = spin ? 0.1 * (run % 3 + 1) : 0.0;
    const double before = run < 6 ? 0.01 : 0.02;
    table.add_row();
    table.set("terrain_before.level_deviation_m", before);
    table.set("terrain_after.level_deviation_m", before * (1.0 - share));
    table.set("terrain_before.relief_m", 0.5 * before);
    table.set("terrain_after.relief_m", 0.5 * before * (1.0 - share * share));
    table.set("terrain_before.mean_height_m", 0.001);
    table.set("terrain_after.mean_height_m", -0.002);
    table.set("leveling.progress_w2", share);
    table.set("terrain_before.roughness_m", 0.001);
    table.set("terrain_after.roughness_m", 0.002);
    table.set("leveling.progress", 2.0 * share);
    table.set("leveling.transport_per_joule_m4", 3e-6);
    table.set("leveling.stuck", 0.05);
    table.set("energy_j", 100.0);
    table.set("left_bed", run == 4);
    table.set("stopped_early", false);
    table.set("faults", run == 5 ? "stuck" : "none");
  }
  return table;
}

TEST(BenchmarkScore, OfEachEntryOnEachCourse) {
  const std::vector<CourseScore> courses = score_benchmark(plan(), runs(), {}, "walk");
  ASSERT_EQ(courses.size(), 2U);
  EXPECT_EQ(courses[1].levels,
            (std::vector<std::string>{"small", "rough", "gravel", "one", "fixes"}));
  for (const CourseScore& course : courses) {
    ASSERT_EQ(course.entries.size(), 2U);
    const EntryScore& walk = course.entries[0];
    const EntryScore& spin = course.entries[1];
    EXPECT_NEAR(walk.level_change.mean, 0.0, 1e-12);
    EXPECT_FALSE(walk.against_baseline.has_value());
    EXPECT_NEAR(spin.level_change.mean, -0.2, 1e-12);
    EXPECT_GE(spin.level_change.interval.low, -0.3 - 1e-9);
    EXPECT_LE(spin.level_change.interval.high, -0.1 + 1e-9);
    EXPECT_NEAR(spin.progress_w2.mean, 0.2, 1e-12);
    EXPECT_NEAR(spin.relief_change.mean, -0.14 / 3.0, 1e-12);
    EXPECT_NEAR(spin.height_change_m.mean, -0.003, 1e-12);
    EXPECT_NEAR(spin.progress.mean, 0.4, 1e-12);
    EXPECT_NEAR(spin.roughness_change.mean, 1.0, 1e-12);
    EXPECT_NEAR(spin.transport_per_joule.mean, 3.0, 1e-12);
    ASSERT_TRUE(spin.against_baseline.has_value());
    EXPECT_NEAR(spin.against_baseline->difference.mean, -0.2, 1e-12);
    EXPECT_NEAR(spin.against_baseline->test.effect, -1.0, 1e-12);
    EXPECT_NEAR(spin.against_baseline->p_holm, 0.25, 1e-12);  // of three pairs: 2 / 2^3
  }
  EXPECT_EQ(courses[0].entries[1].ended_early, 2U);
  EXPECT_EQ(courses[1].entries[1].ended_early, 0U);
}

/// Relief every minute: of runs 3 to 5 (the spin, first course) it falls to half after 2 and 3
/// minutes, and never.
ValueTable curves() {
  ValueTable table;
  const double falls[3] = {0.25, 0.2, 0.1};
  for (int run = 0; run < 12; ++run) {
    for (int minute = 0; minute < 5; ++minute) {
      const double fall = run / 3 == 1 ? falls[run % 3] : 0.0;
      table.add_row();
      table.set("run", run);
      table.set("time", 60.0 * minute);
      if (minute != 1) table.set("level_deviation", 0.01 * (1.0 - fall * minute));
    }
  }
  return table;
}

TEST(BenchmarkScore, HalfIsReachedWhereHalfOfTheBedsReachIt) {
  const std::vector<CourseScore> courses = score_benchmark(plan(), runs(), curves(), "walk");
  const EntryScore& spin = courses[0].entries[1];
  EXPECT_EQ(spin.halved, 2U);
  EXPECT_EQ(spin.half_time_s, 180.0);
  const EntryScore& walk = courses[0].entries[0];
  EXPECT_EQ(walk.halved, 0U);
  EXPECT_TRUE(std::isnan(walk.half_time_s));
  EXPECT_TRUE(std::isnan(score_benchmark(plan(), runs(), {}, "walk")[0].entries[1].half_time_s));
}

// Numbers without rounding: the height falls from 1/64 to just half of it, or to a little more.
TEST(BenchmarkScore, JustHalfIsHalfOfTheHeightAndOfTheBeds) {
  CampaignPlan four = plan();
  four.settings.seeds = {1, 2, 3, 4};
  // When half is reached, s, of four beds each of the walk and the spin on both courses; 0: never.
  const double reached_s[16] = {60, 0,   0, 0,  //
                                0,  180, 0, 120, 60, 0, 60, 60, 180, 60, 120, 180};
  ValueTable results;
  ValueTable table;
  for (int run = 0; run < 16; ++run) {
    results.add_row();
    results.set("stopped_early", run == 2 || run == 3);
    for (int minute = 0; minute < 4; ++minute) {
      const double time_s = 60.0 * minute;
      double share = 0.5625;
      if (reached_s[run] > 0.0)
        share = time_s < reached_s[run] ? 0.75 : time_s > reached_s[run] ? 0.25 : 0.5;
      table.add_row();
      table.set("run", run);
      table.set("time", time_s);
      table.set("level_deviation", minute == 0 ? 0x1p-6 : 0x1p-6 * share);
    }
  }
  const std::vector<CourseScore> courses = score_benchmark(four, results, table, "walk");
  // One of four beds is no half of them.
  EXPECT_EQ(courses[0].entries[0].halved, 1U);
  EXPECT_TRUE(std::isnan(courses[0].entries[0].half_time_s));
  EXPECT_EQ(courses[0].entries[0].ended_early, 2U);
  // Two are, when the second one has it: of two, three or all four.
  EXPECT_EQ(courses[0].entries[1].halved, 2U);
  EXPECT_EQ(courses[0].entries[1].half_time_s, 180.0);
  EXPECT_EQ(courses[1].entries[0].halved, 3U);
  EXPECT_EQ(courses[1].entries[0].half_time_s, 60.0);
  EXPECT_EQ(courses[1].entries[1].halved, 4U);
  EXPECT_EQ(courses[1].entries[1].half_time_s, 120.0);
}

TEST(BenchmarkScore, TimesTheBaselineIsOfMeansOverTheSameBeds) {
  // The spin does 10, 20, 30 % of the work, the other 5, 10, nothing known; of three beds the last
  // is left out.
  ValueTable table;
  const double shares[2][3] = {{0.05, 0.1, 0.0}, {0.1, 0.2, 0.3}};
  for (int run = 0; run < 12; ++run) {
    table.add_row();
    if (run % 6 != 2) table.set("leveling.progress", shares[run / 3 % 2][run % 3]);
  }
  const std::vector<CourseScore> courses = score_benchmark(plan(), table, {}, "walk");
  const std::optional<SeedMean>& times = courses[0].entries[1].times_baseline;
  ASSERT_TRUE(times.has_value());
  EXPECT_EQ(times->count, 2U);
  EXPECT_NEAR(times->mean, 2.0, 1e-12);
  EXPECT_FALSE(courses[0].entries[0].times_baseline.has_value());
  // By one that changes nothing: no number of times.
  EXPECT_FALSE(score_benchmark(plan(), runs(), {}, "walk")[0].entries[1].times_baseline);
}

TEST(BenchmarkScore, ARunWithoutFiguresIsCountedAsFailed) {
  ValueTable table;
  for (int run = 0; run < 12; ++run) {
    table.add_row();
    if (run == 3) continue;
    table.set("terrain_before.level_deviation_m", 0.01);
    table.set("terrain_after.level_deviation_m", 0.008);
  }
  const std::vector<CourseScore> courses = score_benchmark(plan(), table, {}, "nobody");
  EXPECT_EQ(courses[0].entries[1].runs, 2U);
  EXPECT_EQ(courses[0].entries[1].failed, 1U);
  EXPECT_FALSE(courses[0].entries[1].against_baseline.has_value());
}

constexpr int kSeeds = 4;

CampaignPlan plan_of_worlds(const std::vector<std::string>& worlds) {
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

/// Changes of the height about level by cell, the same on all beds.
ValueTable runs_with(const std::vector<double>& changes) {
  ValueTable table;
  for (const double change : changes) {
    for (int seed = 0; seed < kSeeds; ++seed) {
      table.add_row();
      table.set("terrain_before.level_deviation_m", 0.01 * (seed + 1));
      table.set("terrain_after.level_deviation_m", 0.01 * (seed + 1) * (1.0 + change));
    }
  }
  return table;
}

TEST(WorldRanking, ComparesTheOrderOfEachCourseAndOfAll) {
  // On gravel the other world has the same order, on sand the opposite one.
  const auto rankings = rank_worlds(plan_of_worlds({"physics", "stand_in"}),
                                    runs_with({-0.1, -0.2, -0.5, -0.01, -0.02, -0.03,  //
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
  ValueTable table = runs_with({-0.1, -0.2, -0.5, -0.01, -0.02, -0.03,  //
                                -0.1, -0.3, -0.4, -0.03, -0.02, -0.01});
  EXPECT_NEAR(rank_worlds(plan_of_worlds({"physics", "stand_in"}), table)[0].reference_halves, 1.0,
              1e-12);
  // On gravel walk and spin change places on two of four beds. Two of three halves have a bed of
  // each kind, in which the two are alike: the other pairs agree. In the third they stand the other
  // way round: two pairs of three agree.
  const std::vector<double> walk = {-0.1, -0.1, -0.3, -0.3};
  const std::vector<double> spin = {-0.3, -0.3, -0.1, -0.1};
  ValueTable swapped;
  const auto add = [&](double change) {
    swapped.add_row();
    swapped.set("terrain_before.level_deviation_m", 0.01);
    swapped.set("terrain_after.level_deviation_m", 0.01 * (1.0 + change));
  };
  for (int cell = 0; cell < 12; ++cell) {
    for (std::size_t bed = 0; bed < 4; ++bed) {
      add(cell == 0 ? walk[bed] : cell == 1 ? spin[bed] : cell == 2 ? -0.5 : -0.01 * cell);
    }
  }
  const auto rankings = rank_worlds(plan_of_worlds({"physics", "stand_in"}), swapped);
  EXPECT_NEAR(rankings[0].reference_halves, (2.0 * 1.0 + 1.0 / 3.0) / 3.0, 0.05);
  EXPECT_NEAR(rankings[1].reference_halves, 1.0, 1e-12);
  // Entries that are all alike order nothing.
  const ValueTable alike = runs_with(std::vector<double>(12, -0.1));
  EXPECT_TRUE(
      std::isnan(rank_worlds(plan_of_worlds({"physics", "stand_in"}), alike)[0].reference_halves));
}

TEST(WorldRanking, LeavesOutBedsWithoutAValue) {
  ValueTable table = runs_with({-0.1, -0.2, -0.5, -0.01, -0.02, -0.03,  //
                                -0.1, -0.3, -0.4, -0.01, -0.02, -0.03});
  table.set("terrain_after.level_deviation_m", nullptr);  // of the last run
  const auto rankings = rank_worlds(plan_of_worlds({"physics", "stand_in"}), table);
  EXPECT_EQ(rankings[0].tau.count, 4U);
  EXPECT_EQ(rankings[1].tau.count, 3U);
  EXPECT_EQ(rankings[2].tau.count, 3U);
}

TEST(WorldRanking, OfOneWorldThereIsNone) {
  EXPECT_TRUE(
      rank_worlds(plan_of_worlds({"physics"}), runs_with(std::vector<double>(6, -0.1))).empty());
  CampaignPlan without = plan_of_worlds({"physics"});
  without.factors.erase(without.factors.begin());
  for (auto& cell : without.cells) cell.erase(cell.begin());
  EXPECT_TRUE(rank_worlds(without, runs_with(std::vector<double>(6, -0.1))).empty());
}

}  // namespace
}  // namespace screed
