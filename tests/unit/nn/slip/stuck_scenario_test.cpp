// What the seeded drives of the slip watch draw from.
#include "nn/slip/stuck_scenario.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "firmware/leveling/behaviour.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/world/placement.h"
#include "nn/slip/escape_run.h"

namespace screed::nn {
namespace {

TEST(StuckScenario, DrawsEverySoilAndEveryTrap) {
  std::set<std::string> grounds;
  std::set<std::string> traps;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const StuckScenario scenario = stuck_scenario(seed, ScenarioKind::kTrapped, 10.0);
    grounds.insert(scenario.ground);
    traps.insert(scenario.experiment.trap.kind);
    EXPECT_EQ(scenario.experiment.map.model, scenario.ground == "rigid" ? "rigid" : "scm");
    if (scenario.ground != "rigid") {
      EXPECT_EQ(scenario.experiment.soil.preset, scenario.ground);
    }
  }
  std::set<std::string> soils = {"rigid"};
  for (const std::string& name : soil_preset_names()) soils.insert(name);
  EXPECT_EQ(grounds, soils);
  const std::vector<std::string> kinds = trap_kinds();
  EXPECT_EQ(traps, std::set<std::string>(kinds.begin() + 1, kinds.end()));
}

TEST(StuckScenario, OrdinaryDrivesRunEveryLevelingAlgorithmAndMeetTheirOwnRuts) {
  std::set<std::string> algorithms;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    const Experiment e = stuck_scenario(seed, ScenarioKind::kOrdinary, 10.0).experiment;
    EXPECT_EQ(e.trap.kind, "none");
    algorithms.insert(e.experiment.algorithm);
    if (e.experiment.algorithm == "drive") {
      EXPECT_LE(e.map.size_m, 3.0) << "round the bed in a drive";
      EXPECT_EQ(e.drive.yaw_rate_deg_per_s, 0.0);
    }
  }
  EXPECT_EQ(algorithms, (std::set<std::string>{"hill_sensing", "spin_on_peak", "random_walk",
                                               "training_drive", "drive"}));
}

TEST(StuckScenario, HalfOfTheOrdinaryDrivesAreInBedsWithWalls) {
  int beds = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const Experiment e = stuck_scenario(seed, ScenarioKind::kOrdinary, 10.0).experiment;
    if (e.map.edges != "walls") continue;
    ++beds;
    EXPECT_LE(e.map.size_m, 3.0);
    EXPECT_LE(e.map.max_slope_deg, 25.0);
    EXPECT_LE(std::max(std::abs(e.vehicle.x_m), std::abs(e.vehicle.y_m)), 0.3) << "clear of them";
  }
  EXPECT_NEAR(beds, 50, 15);
}

TEST(StuckScenario, KindsOfTheSameSeedAreDrivesOfTheirOwn) {
  const Experiment free = stuck_scenario(3, ScenarioKind::kFree, 10.0).experiment;
  const Experiment trapped = stuck_scenario(3, ScenarioKind::kTrapped, 10.0).experiment;
  EXPECT_NE(free.vehicle.x_m, trapped.vehicle.x_m);
  EXPECT_EQ(free.trap.kind, "none");
  EXPECT_NE(trapped.trap.kind, "none");
}

// ---- Trials of the escape: their scenarios, and what counts as stuck

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
