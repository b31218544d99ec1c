// How often a run tells how far it has come.
#include "host_sim/run/simulation/run_loop.h"

#include <gtest/gtest.h>

#include <vector>

namespace screed {
namespace {

LevelingPoint off_level_by(double metres) {
  LevelingPoint point;
  point.level_deviation = metres;
  return point;
}

TEST(Progress, TellsTenTimesASecondAndAtTheEnd) {
  Experiment experiment;
  experiment.experiment.duration_s = 0.25;
  StopCondition stop(experiment, nullptr);
  std::vector<SimulationProgress> told;
  Progress progress([&](const SimulationProgress& one) { told.push_back(one); });
  progress.on_leveling(off_level_by(0.02));
  for (int tick = 1; tick <= 25; ++tick) {
    if (tick == 15) progress.on_leveling(off_level_by(0.01));
    stop.count_tick(RobotState::kRunning, message::LevelingState::kWalk);
    progress.on_tick(stop, tick * 0.01);
  }
  ASSERT_EQ(told.size(), 3U);
  EXPECT_DOUBLE_EQ(told[0].time_s, 0.1);
  EXPECT_DOUBLE_EQ(told[1].time_s, 0.2);
  EXPECT_DOUBLE_EQ(told[2].time_s, 0.25);
  EXPECT_DOUBLE_EQ(told[2].duration_s, 0.25);
  EXPECT_EQ(told[0].level_deviation_m, 0.02);
  EXPECT_EQ(told[2].level_deviation_m, 0.01);
  for (const SimulationProgress& one : told) EXPECT_EQ(one.level_deviation_before_m, 0.02);
}

}  // namespace
}  // namespace screed
