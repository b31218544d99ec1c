// Scores of made-up runs, whose figures are known.
#include "host_sim/benchmark/benchmark_score.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "host_sim/benchmark/benchmark_file.h"

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

/// The walk leaves the relief as it is; the spin takes 10, 20 and 30 % of it, of twice as much on
/// the second course.
ValueTable runs() {
  ValueTable table;
  for (int run = 0; run < 12; ++run) {
    const bool spin = run / 3 % 2 == 1;
    const double share = spin ? 0.1 * (run % 3 + 1) : 0.0;
    const double before = run < 6 ? 0.01 : 0.02;
    table.add_row();
    table.set("terrain_before.relief_m", before);
    table.set("terrain_after.relief_m", before * (1.0 - share));
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
  const std::vector<CourseScore> courses = score_benchmark(plan(), runs(), "walk");
  ASSERT_EQ(courses.size(), 2U);
  EXPECT_EQ(courses[1].levels,
            (std::vector<std::string>{"small", "rough", "gravel", "one", "fixes"}));
  for (const CourseScore& course : courses) {
    ASSERT_EQ(course.entries.size(), 2U);
    const EntryScore& walk = course.entries[0];
    const EntryScore& spin = course.entries[1];
    EXPECT_NEAR(walk.relief_change.mean, 0.0, 1e-12);
    EXPECT_FALSE(walk.against_baseline.has_value());
    EXPECT_NEAR(spin.relief_change.mean, -0.2, 1e-12);
    EXPECT_GE(spin.relief_change.interval.low, -0.3 - 1e-9);
    EXPECT_LE(spin.relief_change.interval.high, -0.1 + 1e-9);
    EXPECT_NEAR(spin.rate_per_h.mean, 0.4, 1e-12);
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

TEST(BenchmarkScore, ARunWithoutFiguresIsCountedAsFailed) {
  ValueTable table;
  for (int run = 0; run < 12; ++run) {
    table.add_row();
    if (run == 3) continue;
    table.set("terrain_before.relief_m", 0.01);
    table.set("terrain_after.relief_m", 0.008);
  }
  const std::vector<CourseScore> courses = score_benchmark(plan(), table, "nobody");
  EXPECT_EQ(courses[0].entries[1].runs, 2U);
  EXPECT_EQ(courses[0].entries[1].failed, 1U);
  EXPECT_FALSE(courses[0].entries[1].against_baseline.has_value());
}

}  // namespace
}  // namespace screed
