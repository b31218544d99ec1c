// When a run is measured, and what of.
#include "host_sim/run/simulation/outcome.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "firmware/robot/supervisor.h"
#include "host_sim/physics/terrain/low_pass.h"
#include "schema/values.h"

namespace screed {
namespace {

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
