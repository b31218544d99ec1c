// A run, tick by tick: pace, progress, telemetry, order.
#include <gtest/gtest.h>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/run_loop.h"
#include "tests/temp_folder.h"
#include "tests/unit/host_sim/run/rover5_plant.h"
#include "tests/unit/test_robot.h"

namespace screed {

namespace {

// Pacing by a clock that only moves when told to.

using namespace std::chrono_literals;

class FakeClock : public WallClock {
 public:
  Time now() const override { return time; }
  void sleep_until(Time until) override {
    slept_to.push_back(until);
    time = std::max(time, until);
  }

  Time time{1000s};
  std::vector<Time> slept_to;
};

TEST(Pacer, SleepsUntilTheClockHasCaughtUp) {
  FakeClock clock;
  Pacer pacer(clock, true);
  pacer.wait_until(0.01);
  pacer.wait_until(0.02);
  ASSERT_EQ(clock.slept_to.size(), 2U);
  EXPECT_EQ(clock.slept_to[0] - FakeClock::Time(1000s), 10ms);
  EXPECT_EQ(clock.slept_to[1] - FakeClock::Time(1000s), 20ms);
  EXPECT_DOUBLE_EQ(pacer.elapsed_s(), 0.02);
}

TEST(Pacer, ALateRunIsNotPacedByItsDelay) {
  FakeClock clock;
  Pacer pacer(clock, true);
  clock.time += 3s;
  pacer.wait_until(1.0);
  EXPECT_DOUBLE_EQ(pacer.elapsed_s(), 3.0);
  pacer.wait_until(3.5);
  EXPECT_DOUBLE_EQ(pacer.elapsed_s(), 3.5);
}

TEST(Pacer, NeverSleepsWithoutRealtime) {
  FakeClock clock;
  Pacer pacer(clock, false);
  pacer.wait_until(5.0);
  EXPECT_TRUE(clock.slept_to.empty());
  clock.time += 250ms;
  EXPECT_DOUBLE_EQ(pacer.elapsed_s(), 0.25);
}

// How often a run tells how far it has come.

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

// What a robot sent, in frames and as a share of its line.

RobotOutput sending(std::string_view bytes) {
  RobotOutput output{};
  std::copy(bytes.begin(), bytes.end(), output.radio_out);
  output.radio_out_count = static_cast<uint8_t>(bytes.size());
  return output;
}

TEST(TelemetryMeter, CountsWholeLinesAndAllBytes) {
  TelemetryMeter meter;
  meter.add(0, sending("t1001FF\rt1011"));
  meter.add(0, sending("00\r"));
  meter.add(0, sending(""));
  EXPECT_EQ(meter.frames(), 2U);
  EXPECT_DOUBLE_EQ(meter.line_share(1.0), 16.0 / 5760.0);
  EXPECT_DOUBLE_EQ(meter.line_share(0.01), 16.0 / 57.6);
}

TEST(TelemetryMeter, KeepsTheLastFrameOfEachMessage) {
  TelemetryMeter meter;
  // POWER of robot 1, cut in two: 7200 mV, then 5000 mV.
  meter.add(10'000, sending("t31450000201C"));
  EXPECT_FALSE(meter.latest().value("power.battery").has_value());
  meter.add(20'000, sending("07\r"));
  EXPECT_EQ(meter.latest().value("power.battery"), 7200.0);
  meter.add(30'000, sending("t31450000881307\r"));
  EXPECT_EQ(meter.latest().value("power.battery"), 5000.0);
  EXPECT_EQ(meter.latest().age_s(*find_message("POWER"), 1'030'000), 1.0);
}

TEST(TelemetryMeter, BytesBehindTheValidOnesAreNotSent) {
  RobotOutput output = sending("t1000\rt1000\r");
  output.radio_out_count = 6;
  TelemetryMeter meter;
  meter.add(0, output);
  EXPECT_EQ(meter.frames(), 1U);
}

// The order of things in a tick.

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
