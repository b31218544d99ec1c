// What becomes of a run: names, terrain, end, measures.
#include <gtest/gtest.h>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "firmware/robot/supervisor.h"
#include "host_sim/physics/terrain/low_pass.h"
#include "host_sim/run/simulation/outcome.h"
#include "schema/values.h"
#include "tests/unit/host_sim/run/rover5_plant.h"
#include "tools/schema/dbc.h"

namespace screed {

namespace {

// Names of states and faults as summaries, pictures and the viewer show them.

TEST(Names, StatesAndFaultsAreCalledWhatTheSchemaCallsThem) {
  size_t states = 0;
  for (const schema::DbcMessage& message :
       schema::read_dbc("firmware/protocol/screed.dbc").messages) {
    for (const schema::DbcSignal& signal : message.signals) {
      for (const schema::ValueName& value : signal.values) {
        const std::string path = message.name + "." + signal.name;
        if (path == "HEARTBEAT.state") {
          EXPECT_EQ(state_name(static_cast<RobotState>(value.value)), value.name);
        } else if (path == "LEVELING.state") {
          EXPECT_EQ(leveling_state_name(static_cast<message::LevelingState>(value.value)),
                    value.name);
          EXPECT_LT(static_cast<size_t>(value.value), kLevelingStates);
          ++states;
        }
      }
    }
  }
  EXPECT_EQ(states, kLevelingStates);
}

TEST(Names, WhatHasNoNameIsUnknown) {
  EXPECT_STREQ(state_name(static_cast<RobotState>(7)), "unknown");
  EXPECT_STREQ(leveling_state_name(static_cast<message::LevelingState>(15)), "unknown");
}

TEST(Names, FaultsAreListedInTheirOrder) {
  EXPECT_EQ(fault_names(0), "none");
  EXPECT_EQ(fault_names(Fault::kStallRight), "stall_right");
  EXPECT_EQ(fault_names(Fault::kStuck | Fault::kTilt), "tilt, stuck");
}

// What a run did to its terrain, on soil and on particles.

using std::numbers::pi;

Experiment on(const char* model) {
  Experiment experiment;
  experiment.map.model = model;
  return experiment;
}

/// Stones of 25 mm side by side on a slope: rows of half circles.
HeightField stones() {
  return HeightField::from_function(201, 201, 0.005, false, [](double x, double y) {
    const auto from_middle = [](double at) { return at - 0.025 * std::round(at / 0.025); };
    const double off = std::hypot(from_middle(x), from_middle(y));
    const double stone = std::sqrt(std::max(0.0, 0.0125 * 0.0125 - off * off));
    return stone + x * std::tan(3.0 * pi / 180.0);
  });
}

TEST(TerrainMeasure, SingleStonesAreNoSlopes) {
  Experiment experiment = on("particles");
  experiment.map.particle_radius_m = 0.0125;
  const TerrainMeasure measure(experiment);
  const HeightField bed = stones();
  EXPECT_GT(terrain_statistics(bed).mean_slope_deg, 30.0);
  EXPECT_LT(flatness(bed, 5.0), 0.2);

  const HeightField surface = measure.surface(bed);
  const TerrainStatistics heights = terrain_statistics(surface);
  EXPECT_NEAR(heights.mean_slope_deg, 3.0, 0.2);
  EXPECT_GT(flatness(surface, 5.0), 0.99);
  EXPECT_EQ(measure.outcome(surface, surface).after.flatness, flatness(surface, 5.0));
}

TEST(TerrainMeasure, TakesOtherTerrainAsItIs) {
  const HeightField bed = stones();
  for (const char* model : {"rigid", "scm"}) {
    const TerrainMeasure measure(on(model));
    EXPECT_EQ(terrain_change(bed, measure.surface(bed)).cut_m3, 0.0) << model;
    EXPECT_EQ(terrain_change(bed, measure.surface(bed)).fill_m3, 0.0) << model;
  }
}

TEST(TerrainMeasure, TheExperimentSaysWhatIsFlat) {
  Experiment experiment = on("scm");
  experiment.experiment.flatness_deg = 8.0;
  const HeightField ramp = HeightField::ramp(1.0, 0.01, 8.0);
  const HeightField steeper = HeightField::ramp(1.0, 0.01, 8.1);
  const TerrainOutcome outcome = TerrainMeasure(experiment).outcome(steeper, ramp);
  EXPECT_EQ(outcome.before.flatness, 0.0);
  EXPECT_EQ(outcome.after.flatness, 1.0);
}

TEST(TerrainMeasure, TellsBeforeFromAfter) {
  const HeightField before = HeightField::ramp(1.0, 0.01, 2.0);
  HeightField after = before;
  after.set_node(50, 50, after.node(50, 50) - 300000);
  after.set_node(60, 50, after.node(60, 50) + 200000);
  const TerrainOutcome outcome = TerrainMeasure(on("scm")).outcome(before, after);
  EXPECT_LT(outcome.before.heights.steepest_slope_deg, 2.1);
  EXPECT_GT(outcome.after.heights.steepest_slope_deg, 10.0);
  EXPECT_LT(outcome.before.robot_scale.roughness_m, 1e-6);
  EXPECT_GT(outcome.after.robot_scale.roughness_m, 1e-4);
  EXPECT_DOUBLE_EQ(outcome.change.deepest_cut_m, 300000 * kHeightUnit_m);
  EXPECT_DOUBLE_EQ(outcome.change.deepest_fill_m, 200000 * kHeightUnit_m);
}

// When a run ends, and which reason it gives.

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

// When a run is measured, and what of.

constexpr double kTread_m = 0.2;

HeightField hills() {
  return HeightField::from_function(60, 60, 0.02, true, [](double x, double y) {
    return 0.02 * std::cos(2.0 * std::numbers::pi * x / 0.6) *
           std::cos(2.0 * std::numbers::pi * y / 1.2);
  });
}

class LevelingMonitorTest : public ::testing::Test {
 protected:
  /// Ticks up to this time, on terrain that stays as it is.
  void run(LevelingMonitor& monitor, double duration_s) {
    monitor.begin(terrain_, sink_);
    SimFrame frame;
    for (int tick = 1; tick <= std::lround(duration_s * kTickRate_hz); ++tick) {
      frame.time = tick * 0.01;
      frame.energy = 2.0 * frame.time;
      monitor.on_tick({&frame, 1}, 0.1 * frame.time, now_, sink_);
    }
    monitor.end(terrain_, sink_);
  }
  std::vector<double> times() const {
    std::vector<double> times;
    for (const LevelingPoint& point : points_) times.push_back(point.time);
    return times;
  }
  std::vector<double> transport_times() const {
    std::vector<double> times;
    for (const LevelingPoint& point : points_) {
      if (!std::isnan(point.transport)) times.push_back(point.time);
    }
    return times;
  }

  Experiment experiment_;
  HeightField terrain_ = hills();
  int asked_ = 0;
  LevelingMonitor::Surface now_ = [this]() -> const HeightField& {
    ++asked_;
    return terrain_;
  };
  std::vector<LevelingPoint> points_;
  LevelingMonitor::Sink sink_ = [this](const LevelingPoint& point) { points_.push_back(point); };
};

TEST_F(LevelingMonitorTest, CountsTimeOnTheWayBackOfARobotThatRuns) {
  LevelingMonitor monitor(experiment_, kTread_m, true);
  monitor.begin(terrain_, sink_);
  SimFrame frame;
  const auto drive = [&](RobotState state, message::LevelingState activity, int ticks) {
    frame.state = static_cast<int>(state);
    frame.leveling_state = static_cast<int>(activity);
    for (int i = 0; i < ticks; ++i) {
      frame.time += 0.01;
      monitor.on_tick({&frame, 1}, 0.0, now_, sink_);
    }
  };
  drive(RobotState::kRunning, message::LevelingState::kWalk, 50);
  drive(RobotState::kRunning, message::LevelingState::kReturn, 30);
  drive(RobotState::kFault, message::LevelingState::kReturn, 20);
  monitor.end(terrain_, sink_);
  EXPECT_DOUBLE_EQ(points_.back().returning, 0.3);
}

TEST_F(LevelingMonitorTest, MeasuresAtTheStartAtMultiplesAndAtTheEnd) {
  experiment_.metrics.interval_s = 0.5;
  experiment_.metrics.transport_interval_s = 1.0;
  LevelingMonitor monitor(experiment_, kTread_m, true);
  run(monitor, 1.7);
  EXPECT_EQ(times(), (std::vector<double>{0.0, 0.5, 1.0, 1.5, 1.7}));
  EXPECT_EQ(transport_times(), (std::vector<double>{0.0, 1.0, 1.7}));
  EXPECT_DOUBLE_EQ(points_.back().energy, 3.4);
  EXPECT_DOUBLE_EQ(points_.back().distance, 0.17);
  EXPECT_EQ(points_.back().progress, 0.0);
  EXPECT_EQ(monitor.outcome().before.time, 0.0);
  EXPECT_EQ(monitor.outcome().after.time, 1.7);
  EXPECT_EQ(asked_, 3) << "a bed of particles casts rays for its surface: for points alone";
}

TEST_F(LevelingMonitorTest, TheEndHasTransportEvenWhereAPointIsDue) {
  experiment_.metrics.interval_s = 0.5;
  experiment_.metrics.transport_interval_s = 0.0;
  LevelingMonitor monitor(experiment_, kTread_m, true);
  run(monitor, 1.0);
  EXPECT_EQ(times(), (std::vector<double>{0.0, 0.5, 1.0, 1.0}));
  EXPECT_TRUE(std::isnan(points_[2].transport));
  EXPECT_FALSE(std::isnan(points_[3].transport));
}

TEST_F(LevelingMonitorTest, TerrainThatCannotDeformHasNoTransport) {
  experiment_.metrics.interval_s = 0.5;
  LevelingMonitor monitor(experiment_, kTread_m, false);
  run(monitor, 0.7);
  EXPECT_EQ(times().size(), 3U);
  EXPECT_TRUE(transport_times().empty());
  EXPECT_GT(points_.back().relief, 0.001);
}

TEST_F(LevelingMonitorTest, LooksAtTheFilteredSurfaceOfParticles) {
  experiment_.map.model = "particles";
  experiment_.map.particle_radius_m = 0.0125;
  LevelingMonitor monitor(experiment_, kTread_m, true);
  run(monitor, 0.1);
  const HeightField filtered = low_passed(terrain_, 0.0125);
  const LevelingPoint expected = LevelingMeter(5.0).measure(filtered, {}, true);
  EXPECT_EQ(points_[0].relief, expected.relief);
  EXPECT_EQ(points_[0].height_deviation, expected.height_deviation);
  EXPECT_EQ(points_[0].transport, expected.transport);
  EXPECT_LT(points_[0].height_deviation,
            LevelingMeter(5.0).measure(terrain_, {}, false).height_deviation);
}

TEST_F(LevelingMonitorTest, TheLimitsAreThoseOfTheRobotsParameters) {
  experiment_.parameters.tilt_limit() = 1000;  // 10 degrees
  experiment_.parameters.site_radius() = 50;   // mm
  experiment_.metrics.interval_s = 1e6;
  LevelingMonitor monitor(experiment_, kTread_m, false);
  monitor.begin(terrain_, sink_);
  SimFrame frame;
  frame.delta_x = 0.01;
  for (int tick = 1; tick <= 10; ++tick) {
    frame.time = tick * 0.01;
    frame.pitch = tick <= 4 ? 0.18 : 0.17;  // 10 degrees are 0.1745
    monitor.on_tick({&frame, 1}, 0.0, now_, sink_);
  }
  monitor.end(terrain_, sink_);
  EXPECT_DOUBLE_EQ(points_.back().tilted, 0.4);
  EXPECT_NEAR(points_.back().off_site, 0.5, 0.11);
}

TEST_F(LevelingMonitorTest, OfSeveralRobotsCostsAreSumsAndSharesAreMeans) {
  experiment_.robots.count = 2;
  LevelingMonitor monitor(experiment_, kTread_m, true);
  monitor.begin(terrain_, sink_);
  std::array<SimFrame, 2> frames{};
  constexpr int kTicks = 400;
  for (int tick = 1; tick <= kTicks; ++tick) {
    // One drives, tilted; the other one is stuck: its tracks run on the spot.
    for (SimFrame& frame : frames) {
      frame.time = tick * 0.01;
      frame.track_left = frame.track_right = 0.2;
      frame.energy = frame.time;
    }
    frames[0].velocity_x = 0.2;
    frames[0].pitch = 1.0;
    frames[1].slip_left = frames[1].slip_right = 1.0;
    monitor.on_tick(frames, 0.2 * frames[0].time, now_, sink_);
  }
  monitor.end(terrain_, sink_);
  EXPECT_DOUBLE_EQ(points_.back().energy, 8.0);
  EXPECT_DOUBLE_EQ(points_.back().tilted, 0.5);
  EXPECT_DOUBLE_EQ(points_.back().slip, 0.5);
  // The second in which it could not be known yet is not counted.
  EXPECT_DOUBLE_EQ(points_.back().stuck, 0.5 * (kTicks - 99) / kTicks);
}

}  // namespace

}  // namespace screed
