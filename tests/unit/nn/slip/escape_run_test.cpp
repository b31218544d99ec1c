// Trials of the escape: their scenarios, and what counts as stuck.
#include "nn/slip/escape_run.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "firmware/leveling/behaviour.h"

namespace screed::nn {
namespace {

TEST(EscapeScenario, IsTheTrappedDriveByAnAlgorithmThatEscapes) {
  std::set<std::string> algorithms;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const StuckScenario drive = stuck_scenario(seed, ScenarioKind::kTrapped, 14.0);
    const StuckScenario escape = escape_scenario(seed);
    EXPECT_EQ(escape.ground, drive.ground);
    EXPECT_EQ(escape.experiment.trap.kind, drive.experiment.trap.kind);
    EXPECT_EQ(escape.experiment.trap.size, drive.experiment.trap.size);
    EXPECT_EQ(escape.experiment.vehicle.heading_deg, drive.experiment.vehicle.heading_deg);
    algorithms.insert(escape.experiment.experiment.algorithm);
    const Parameters& parameters = escape.experiment.parameters;
    EXPECT_TRUE(parameters.valid()) << seed;
    EXPECT_GT(parameters.escape_attempts(), 0);
    if (drive.experiment.experiment.algorithm != "drive") continue;
    EXPECT_NEAR(parameters.walk_speed_max(), drive.experiment.drive.speed_m_per_s * 1000.0, 0.5);
    EXPECT_EQ(parameters.walk_speed_min(), parameters.walk_speed_max());
    EXPECT_EQ(parameters.walk_yaw_rate_max() == 0,
              drive.experiment.drive.yaw_rate_deg_per_s == 0.0);
  }
  EXPECT_EQ(algorithms, (std::set<std::string>{"hill_sensing", "random_walk"}));
}

TEST(EscapeScenario, ManoeuvresAreBoundedAndHaveTheirOwnNames) {
  std::set<std::string> names;
  for (const Manoeuvre& manoeuvre : oracle_manoeuvres()) {
    EXPECT_TRUE(names.insert(manoeuvre.name).second) << manoeuvre.name;
    ASSERT_FALSE(manoeuvre.steps.empty());
    for (const ManoeuvreStep& step : manoeuvre.steps) {
      EXPECT_GT(step.duration_s, 0.0);
      EXPECT_LE(std::abs(step.speed_m_per_s), 0.25);
      EXPECT_LE(std::abs(step.turn_deg_per_s), 90.0);
    }
  }
}

// A rigid slope: by its pitch the robot takes it for a wall and backs off before its tracks slip
// for long. It was never stuck, and neither a success nor a failure of the escape.
TEST(EscapeTrials, WhoBacksOffBeforeTheAlarmWasNotStuck) {
  const EscapeResult result = escape_trials(480020, {.oracle = false});
  ASSERT_EQ(result.scenario.experiment.trap.kind, "slope");
  EXPECT_TRUE(result.backed_off);
  EXPECT_FALSE(result.stuck);
  EXPECT_FALSE(result.recoverable);
}

}  // namespace
}  // namespace screed::nn
