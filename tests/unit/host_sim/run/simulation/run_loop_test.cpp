// The order of things in a tick, around an image that is a robot in disguise.
#include "host_sim/run/simulation/run_loop.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/run/session/session_reader.h"
#include "tests/temp_folder.h"
#include "tests/unit/host_sim/run/rover5_plant.h"
#include "tests/unit/test_robot.h"

namespace screed {
namespace {

/// Stands for the microcontroller: in every tick physics goes on for 10 ms, and a robot answers.
class FakeImage : public CoSimulation {
 public:
  const SensorSample& run_to_sample() override {
    world_.advance();
    robot_.tick();
    if (++ticks_ == wrong_tick) robot_.output.leds ^= kLedGreen;
    return robot_.sample;
  }
  const RobotOutput& run_to_output() override { return robot_.output; }

  World& world() override { return world_; }
  CycleReport cycles() const override { return {}; }

  int wrong_tick = 0;

 private:
  World world_{HeightField::flat(4.0, 0.1), rover5(), kBoard, WorldOptions{}, nullptr};
  TestRobot robot_;
  int ticks_ = 0;
};

class Observer : public SimulationObserver {
 public:
  void on_begin(const HeightField& before, const HeightField& /*ground*/) override {
    calls += 'b';
    first_height = before.node(0);
  }
  void on_tick(const SimFrame& frame, const HeightField& /*ground*/) override {
    calls += 't';
    times.push_back(frame.time);
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

class RunLoopTest : public ::testing::Test {
 protected:
  RunLoopTest() {
    laid_out_.set_node(0, 0, 4711);
    auto image = std::make_unique<FakeImage>();
    image_ = image.get();
    world_ = std::make_unique<RunWorld>(settings_, std::move(image));
  }

  RunEnd run(double duration_s) {
    Experiment experiment;
    experiment.experiment.duration_s = duration_s;
    recorder_ = std::make_unique<SessionRecorder>(session_, SessionInfo{},
                                                  world_->plant().terrain(), std::nullopt);
    StopCondition stop(experiment, &stop_);
    Progress progress({});
    Pacer pacer(clock_, true);
    LevelingMonitor leveling(experiment, 0.2, false);
    RunLoop loop(*world_,
                 {robot_, *recorder_, leveling, stop, progress, pacer, &observer_, laid_out_});
    return loop.run();
  }

  TempFolder folder_;
  std::filesystem::path session_ = folder_.path() / "session.h5";
  RobotSettings settings_{kBoard, Parameters{}, credentials_of(test_key())};
  FakeImage* image_ = nullptr;
  std::unique_ptr<RunWorld> world_;
  WatchedRobot robot_{settings_};
  std::unique_ptr<SessionRecorder> recorder_;
  std::atomic<bool> stop_ = false;
  StandingClock clock_;
  HeightField laid_out_ = HeightField::flat(4.0, 0.1);
  Observer observer_;
};

TEST_F(RunLoopTest, EachTickIsCheckedRecordedShownAndPaced) {
  EXPECT_EQ(run(0.03), RunEnd::kDone);
  EXPECT_EQ(robot_.parity.ticks(), 3U);
  EXPECT_EQ(observer_.calls, "bttte");
  EXPECT_EQ(observer_.first_height, 4711) << "the terrain before the run, not the plant's";
  ASSERT_EQ(observer_.times.size(), 3U);
  EXPECT_DOUBLE_EQ(observer_.times[2], 0.03);
  ASSERT_EQ(clock_.slept_to.size(), 3U);
  EXPECT_EQ(clock_.slept_to[2].time_since_epoch(), std::chrono::milliseconds(30));
  recorder_->finish(world_->plant().terrain());
  EXPECT_EQ(SessionReader(session_).frames(), 3U);
}

TEST_F(RunLoopTest, ARobotThatDiffersFromItsShadowEndsTheRunUnrecorded) {
  image_->wrong_tick = 2;
  try {
    run(1.0);
    FAIL() << "the run went on";
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("in tick 2: leds"), std::string::npos) << error.what();
  }
  EXPECT_EQ(observer_.calls, "bt");
}

TEST_F(RunLoopTest, NoTickBeginsAfterTheRunWasToldToStop) {
  stop_ = true;
  EXPECT_EQ(run(1.0), RunEnd::kStopped);
  EXPECT_EQ(observer_.calls, "be");
  EXPECT_DOUBLE_EQ(world_->plant().time_s(), 0.0);
}

TEST_F(RunLoopTest, AnImageEndsWithTheWorldsClock) {
  // Busy with its start for so long: no tick of its own has been counted yet.
  for (int i = 0; i < 5; ++i) image_->run_to_sample();
  ASSERT_DOUBLE_EQ(image_->world().plant().time_s(), 0.05);
  EXPECT_EQ(run(0.05), RunEnd::kDone);
  EXPECT_EQ(observer_.calls, "be");
}

}  // namespace
}  // namespace screed
