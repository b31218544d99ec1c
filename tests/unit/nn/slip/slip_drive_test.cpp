// Recorded drives as files.
#include "nn/slip/slip_drive.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "host_sim/core/errors.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/world/placement.h"
#include "tests/temp_folder.h"

namespace screed::nn {
namespace {

SlipDrive some_drive(const StuckScenario& scenario) {
  SlipDrive drive = drive_of(scenario);
  drive.failure = "it fell";
  for (std::int16_t i = 0; i < 3; ++i) {
    SlipTick tick{};
    tick.speed_left = i;
    tick.effort_right = static_cast<std::int16_t>(-i);
    tick.gyro = {1, i, -3};
    tick.accel = {4, 5, i};
    tick.yaw_rate = 100000 * i;
    tick.running = i == 1;
    tick.speed = 0.5F * static_cast<float>(i);
    tick.track_right = -1.25F;
    drive.ticks.push_back(tick);
  }
  return drive;
}

TEST(SlipArchive, ADriveComesBack) {
  const TempFolder folder;
  const StuckScenario scenario = stuck_scenario(5, ScenarioKind::kTrapped, 14.0);
  const auto file = folder.path() / archive_name(scenario);
  EXPECT_FALSE(read_drive(file, scenario));
  const SlipDrive drive = some_drive(scenario);
  write_drive(file, drive);
  const auto read = read_drive(file, scenario);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->seed, 5U);
  EXPECT_EQ(read->kind, ScenarioKind::kTrapped);
  EXPECT_EQ(read->trap, scenario.experiment.trap.kind);
  EXPECT_EQ(read->ground, scenario.ground);
  EXPECT_EQ(read->failure, drive.failure);
  ASSERT_EQ(read->ticks.size(), 3U);
  EXPECT_EQ(read->ticks[2].yaw_rate, 200000);
  EXPECT_EQ(read->ticks[2].gyro, drive.ticks[2].gyro);
  EXPECT_EQ(read->ticks[2].accel, drive.ticks[2].accel);
  EXPECT_EQ(read->ticks[2].effort_right, -2);
  EXPECT_TRUE(read->ticks[1].running);
  EXPECT_EQ(read->ticks[2].speed, 1.0F);
  EXPECT_EQ(read->ticks[0].track_right, -1.25F);
}

TEST(SlipArchive, ADamagedFileIsRefused) {
  const TempFolder folder;
  const StuckScenario scenario = stuck_scenario(5, ScenarioKind::kFree, 14.0);
  const auto file = folder.path() / "a.drive";
  write_drive(file, some_drive(scenario));
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 1);
  EXPECT_THROW(read_drive(file, scenario), InputError);
  std::filesystem::resize_file(file, 4);
  EXPECT_THROW(read_drive(file, scenario), InputError);
}

TEST(SlipArchive, NamesTellDrivesApart) {
  const std::string name = archive_name(stuck_scenario(5, ScenarioKind::kFree, 14.0));
  EXPECT_EQ(name.substr(0, 7), "free-5-");
  EXPECT_NE(archive_name(stuck_scenario(5, ScenarioKind::kFree, 15.0)), name) << "longer";
  EXPECT_NE(archive_name(stuck_scenario(5, ScenarioKind::kOrdinary, 14.0)), name);
  EXPECT_EQ(archive_name(stuck_scenario(5, ScenarioKind::kFree, 14.0)), name);
}

// ---- What the seeded drives of the slip watch draw from

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

}  // namespace
}  // namespace screed::nn
