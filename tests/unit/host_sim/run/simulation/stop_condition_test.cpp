// When a run ends, and which reason it gives.
#include "host_sim/run/simulation/outcome.h"

#include <gtest/gtest.h>

#include <string>

#include "tests/unit/host_sim/run/rover5_plant.h"

namespace screed {
namespace {

Experiment lasting(double duration_s) {
  Experiment experiment;
  experiment.experiment.duration_s = duration_s;
  return experiment;
}

Experiment training_drive(uint32_t frames) {
  Experiment experiment = lasting(frames * 0.01);
  experiment.experiment.algorithm = kTrainingDriveName;
  experiment.experiment.frames = frames;
  return experiment;
}

void count(StopCondition& stop, int ticks, RobotState state,
           message::LevelingState leveling = message::LevelingState::kTrainingDrive) {
  for (int i = 0; i < ticks; ++i) stop.count_tick(state, leveling);
}

TEST(StopCondition, EndsWithTheLastTickOfTheDuration) {
  StopCondition stop(lasting(0.05), nullptr);
  count(stop, 4, RobotState::kRunning, message::LevelingState::kWalk);
  EXPECT_EQ(stop.reason(false), std::nullopt);
  count(stop, 1, RobotState::kRunning, message::LevelingState::kWalk);
  EXPECT_EQ(stop.reason(false), RunEnd::kDone);
  EXPECT_EQ(stop.ticks(), 5U);
  EXPECT_EQ(stop.training_frames(), 0U);
  EXPECT_DOUBLE_EQ(stop.counted_s(0.05), 0.05);
}

TEST(StopCondition, ATrainingDriveCountsOnlyTheFramesItDrives) {
  StopCondition stop(training_drive(3), nullptr);
  count(stop, 50, RobotState::kArmed);
  count(stop, 1, RobotState::kRunning, message::LevelingState::kIdle);
  count(stop, 2, RobotState::kRunning);
  EXPECT_EQ(stop.training_frames(), 2U);
  EXPECT_DOUBLE_EQ(stop.counted_s(0.53), 0.02);
  EXPECT_FALSE(stop.done());
  count(stop, 1, RobotState::kRunning);
  EXPECT_TRUE(stop.done());
  EXPECT_EQ(stop.ticks(), 54U);
}

TEST(StopCondition, ATrainingDriveThatNeverStartsEndsAfterAMinute) {
  StopCondition stop(training_drive(3), nullptr);
  count(stop, 6002, RobotState::kDisarmed);
  EXPECT_FALSE(stop.done());
  count(stop, 1, RobotState::kDisarmed);
  EXPECT_EQ(stop.reason(false), RunEnd::kDone);
}

TEST(StopCondition, AFaultEndsATrainingDriveAndNoOtherRun) {
  StopCondition training(training_drive(100), nullptr);
  count(training, 5, RobotState::kRunning);
  EXPECT_EQ(training.reason(false), std::nullopt);
  count(training, 1, RobotState::kFault);
  EXPECT_EQ(training.reason(false), RunEnd::kFault);
  EXPECT_FALSE(training.done());

  StopCondition other(lasting(10.0), nullptr);
  count(other, 1, RobotState::kFault, message::LevelingState::kWalk);
  EXPECT_EQ(other.reason(false), std::nullopt);
}

TEST(StopCondition, EndsWhenToldToOrOffTheBed) {
  std::atomic<bool> told = false;
  const StopCondition stop(lasting(10.0), &told);
  EXPECT_EQ(stop.reason(false), std::nullopt);
  told = true;
  EXPECT_EQ(stop.reason(false), RunEnd::kStopped);
  EXPECT_EQ(stop.reason(true), RunEnd::kLeftBed);
  EXPECT_FALSE(stop.done());
}

TEST(StopCondition, DoneIsTheFirstReasonOfAll) {
  std::atomic<bool> told = true;
  StopCondition stop(training_drive(1), &told);
  count(stop, 1, RobotState::kRunning);
  count(stop, 1, RobotState::kFault);
  EXPECT_EQ(stop.reason(true), RunEnd::kDone);
}

TEST(StopCondition, EachReasonHasWordsOfItsOwn) {
  EXPECT_STREQ(end_text(RunEnd::kLeftBed), "the robot left the bed");
  EXPECT_STREQ(end_text(RunEnd::kStopped), "stopped on request");
  EXPECT_STREQ(end_text(RunEnd::kFault), "a fault stopped the training drive");
  EXPECT_STREQ(end_text(RunEnd::kDone), "done");
}

TEST(FramesToDrive, AreThoseOfTheTrainingDriveUpToItsEarlyEnd) {
  EXPECT_EQ(frames_to_drive(lasting(10.0)), 0U);
  Experiment experiment = training_drive(500);
  EXPECT_EQ(frames_to_drive(experiment), 500U);
  experiment.experiment.stop_after_s = 2.0;
  EXPECT_EQ(frames_to_drive(experiment), 200U);
  experiment.experiment.stop_after_s = 20.0;
  EXPECT_EQ(frames_to_drive(experiment), 500U);
}

TEST(LeftBed, AnyGroundEndsAtItsEdges) {
  const auto flat = [] { return HeightField::flat(2.0, 0.05); };
  EXPECT_FALSE(left_bed(flat(), Plant(flat(), rover5(), on_soil(held_at(0.9, 0.0))).robot(0)));
  EXPECT_TRUE(left_bed(flat(), Plant(flat(), rover5(), on_soil(held_at(1.1, 0.0))).robot(0)));
  EXPECT_TRUE(left_bed(flat(), Plant(flat(), rover5(), on_soil(held_at(0.0, -1.1))).robot(0)));
  EXPECT_FALSE(left_bed(flat(), Plant(flat(), rover5(), held_at(0.9, 0.0)).robot(0)));
  EXPECT_TRUE(left_bed(flat(), Plant(flat(), rover5(), held_at(1.1, 0.0)).robot(0)));
}

}  // namespace
}  // namespace screed
