// Recorded drives as files.
#include "nn/slip/slip_drive.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "host_sim/core/errors.h"
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

}  // namespace
}  // namespace screed::nn
