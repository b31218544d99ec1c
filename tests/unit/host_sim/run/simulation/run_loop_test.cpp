// The order of things in a tick.
#include "host_sim/run/simulation/run_loop.h"

#include <gtest/gtest.h>

#include <memory>
#include <span>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/run/session/session_reader.h"
#include "tests/temp_folder.h"
#include "tests/unit/host_sim/run/rover5_plant.h"
#include "tests/unit/test_robot.h"

namespace screed {
namespace {

class Observer : public SimulationObserver {
 public:
  void on_begin(const HeightField& before, const HeightField& /*ground*/) override {
    calls += 'b';
    first_height = before.node(0);
  }
  void on_tick(std::span<const SimFrame> frames, const HeightField& /*ground*/) override {
    calls += 't';
    times.push_back(frames[0].time);
  }
  void on_end() override { calls += 'e'; }

  std::string calls;
  Height first_height = 0;
  std::vector<double> times;
};

class StandingClock : public WallClock {
 public:
  Time now() const override { return {}; }
  void sleep_until(Time until) override { slept_to.push_back(until); }
  std::vector<Time> slept_to;
};

World world_of(const RobotSettings& settings) {
  WorldOptions options;
  options.robots[0].settings = settings;
  return {std::make_unique<Plant>(HeightField::flat(4.0, 0.1), rover5(), options), options};
}

class RunLoopTest : public ::testing::Test {
 protected:
  RunLoopTest() { laid_out_.set_node(0, 0, 4711); }

  RunEnd run(double duration_s) {
    Experiment experiment;
    experiment.experiment.duration_s = duration_s;
    recorder_ = std::make_unique<SessionRecorder>(session_, SessionInfo{}, world_.plant().terrain(),
                                                  std::nullopt);
    StopCondition stop(experiment, &stop_);
    Progress progress({});
    Pacer pacer(clock_, true);
    LevelingMonitor leveling(experiment, 0.2, false);
    const std::vector<RecordedRobot> robots = {{*robot_, *recorder_}};
    RunLoop loop(world_, {robots, leveling, stop, progress, pacer, &observer_, laid_out_});
    return loop.run();
  }

  TempFolder folder_;
  std::filesystem::path session_ = folder_.path() / "session.h5";
  RobotSettings settings_{kBoard, Parameters{}, credentials_of(test_key())};
  World world_ = world_of(settings_);
  std::unique_ptr<WatchedRobot> robot_ = std::make_unique<WatchedRobot>(settings_);
  std::unique_ptr<SessionRecorder> recorder_;
  std::atomic<bool> stop_ = false;
  StandingClock clock_;
  HeightField laid_out_ = HeightField::flat(4.0, 0.1);
  Observer observer_;
};

TEST_F(RunLoopTest, EachTickIsCheckedRecordedShownAndPaced) {
  EXPECT_EQ(run(0.03), RunEnd::kDone);
  EXPECT_EQ(robot_->parity.ticks(), 3U);
  EXPECT_EQ(observer_.calls, "bttte");
  EXPECT_EQ(observer_.first_height, 4711) << "the terrain before the run, not the plant's";
  ASSERT_EQ(observer_.times.size(), 3U);
  EXPECT_DOUBLE_EQ(observer_.times[2], 0.03);
  ASSERT_EQ(clock_.slept_to.size(), 3U);
  EXPECT_EQ(clock_.slept_to[2].time_since_epoch(), std::chrono::milliseconds(30));
  recorder_->finish(world_.plant().terrain());
  EXPECT_EQ(SessionReader(session_).frames(), 3U);
}

TEST_F(RunLoopTest, ARobotThatDiffersFromItsShadowEndsTheRunUnrecorded) {
  RobotSettings others = settings_;
  others.board.battery_uv_per_lsb *= 2;  // it reads another voltage
  robot_ = std::make_unique<WatchedRobot>(others);
  try {
    run(1.0);
    FAIL() << "the run went on";
  } catch (const RunError& error) {
    // The first telegram about the battery.
    EXPECT_NE(std::string(error.what()).find("in tick 15: radio_out"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(observer_.calls, "b" + std::string(14, 't'));
}

TEST_F(RunLoopTest, NoTickBeginsAfterTheRunWasToldToStop) {
  stop_ = true;
  EXPECT_EQ(run(1.0), RunEnd::kStopped);
  EXPECT_EQ(observer_.calls, "be");
  EXPECT_DOUBLE_EQ(world_.plant().time_s(), 0.0);
}

TEST_F(RunLoopTest, AnImageEndsWithTheWorldsClock) {
  // Busy with its start for so long: no tick of its own has been counted yet.
  for (int i = 0; i < 5; ++i) world_.advance();
  ASSERT_DOUBLE_EQ(world_.plant().time_s(), 0.05);
  EXPECT_EQ(run(0.05), RunEnd::kDone);
  EXPECT_EQ(observer_.calls, "be");
}

}  // namespace
}  // namespace screed
