// Terrain without edges: whoever leaves on one side comes back on the other, and nothing but the
// place shows it (thesis 5.1.4).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/world/frame_recorder.h"
#include "tests/sitl/test_drive.h"

namespace screed::testing {
namespace {

constexpr double kBed_m = 1.2;

/// Hills that repeat with the bed.
HeightField hills(double size_m, bool wrap) {
  const int nodes = static_cast<int>(std::lround(size_m / 0.01)) + (wrap ? 0 : 1);
  return HeightField::from_function(nodes, nodes, 0.01, wrap, [](double x, double y) {
    const double wave = 2.0 * std::numbers::pi / kBed_m;
    return 0.02 * std::sin(wave * x) * std::cos(wave * y);
  });
}

struct Step {
  SimFrame frame;
  Eigen::Vector3d velocity;
};

/// A wide arc, over edges of all four sides.
std::vector<Step> drive_over_the_edges(HeightField terrain, double seconds,
                                       const std::optional<SoilParameters>& soil = {}) {
  WorldOptions options = drive_options(0.2, 4.0);
  options.starts[0].attitude.heading = 0.7;
  options.soil = soil;
  TestDrive drive(std::move(terrain), options);
  FrameRecorder recorder;
  std::vector<Step> steps;
  for (int tick = 0; tick < std::lround(seconds * kTickRate_hz); ++tick) {
    drive.tick();
    steps.push_back(
        {recorder.record(drive.world.plant().time_s(), drive.world.plant().robot(0), drive.robot),
         drive.world.vehicle().chassis().velocity});
  }
  return steps;
}

void expect_no_glitch(const std::vector<Step>& steps, int least_teleports) {
  double jerk = 0.0;
  double jerk_at_teleport = 0.0;
  int teleports = 0;
  double x = steps[0].frame.x + kBed_m * steps[0].frame.beds_x;
  double y = steps[0].frame.y + kBed_m * steps[0].frame.beds_y;
  for (size_t i = 1; i < steps.size(); ++i) {
    const SimFrame& frame = steps[i].frame;
    const SimFrame& last = steps[i - 1].frame;
    ASSERT_TRUE(std::abs(frame.x) <= kBed_m / 2 && std::abs(frame.y) <= kBed_m / 2) << i;
    // A delta is what the velocity makes of a tick, teleported or not, and deltas add up.
    const Eigen::Vector3d mean = 0.5 * (steps[i].velocity + steps[i - 1].velocity);
    ASSERT_NEAR(frame.delta_x, mean.x() / kTickRate_hz, 2e-4) << i;
    ASSERT_NEAR(frame.delta_y, mean.y() / kTickRate_hz, 2e-4) << i;
    x += frame.delta_x;
    y += frame.delta_y;
    ASSERT_NEAR(x, frame.x + kBed_m * frame.beds_x, 1e-9) << i;
    ASSERT_NEAR(y, frame.y + kBed_m * frame.beds_y, 1e-9) << i;
    const bool teleported = frame.beds_x != last.beds_x || frame.beds_y != last.beds_y;
    teleports += teleported ? 1 : 0;
    double& most = teleported ? jerk_at_teleport : jerk;
    most = std::max(most, (steps[i].velocity - steps[i - 1].velocity).norm());
  }
  EXPECT_GE(teleports, least_teleports);
  EXPECT_LE(jerk_at_teleport, jerk);
}

TEST(Teleport, KeepsTheMotionAndDoesNotShowInTheDeltas) {
  expect_no_glitch(drive_over_the_edges(hills(kBed_m, true), 60.0), 8);
}

TEST(Teleport, OnSoilToo) {
  expect_no_glitch(drive_over_the_edges(hills(kBed_m, true), 30.0, soil_preset("viper")), 2);
}

TEST(Teleport, OnParticlesToo) {
  constexpr double kSize_m = 0.6;
  WorldOptions options = drive_options(0.2, 0.0);
  options.starts[0].x_m = 0.25;
  options.particles.emplace();
  TestDrive drive(
      HeightField::from_function(48, 48, kSize_m / 48, true, [](double, double) { return 0.1; }),
      options);
  ASSERT_TRUE(drive.start());
  const double begin = drive.world.plant().robot(0).unwrapped_position().x();
  drive.run(3.0);
  EXPECT_EQ(drive.world.plant().robot(0).wrap_counts()[0], 1);
  EXPECT_LT(std::abs(drive.position().x()), kSize_m / 2);
  const double end = drive.world.plant().robot(0).unwrapped_position().x();
  EXPECT_DOUBLE_EQ(end, drive.position().x() + kSize_m);
  EXPECT_GT(end - begin, 0.2);
  EXPECT_LT(end - begin, 0.7);
  EXPECT_LT(std::abs(drive.attitude().pitch), 0.35);
}

TEST(Teleport, IsTheDriveOnABedThatIsLargeEnough) {
  constexpr double kSeconds = 20.0;
  const std::vector<Step> small = drive_over_the_edges(hills(kBed_m, true), kSeconds);
  const std::vector<Step> large = drive_over_the_edges(hills(15 * kBed_m, false), kSeconds);
  const SimFrame& a = small.back().frame;
  const SimFrame& b = large.back().frame;
  EXPECT_NE(a.beds_x, 0);
  EXPECT_EQ(b.beds_x, 0);
  EXPECT_NEAR(a.x + kBed_m * a.beds_x, b.x, 1e-3);
  EXPECT_NEAR(a.y + kBed_m * a.beds_y, b.y, 1e-3);
  EXPECT_NEAR(a.yaw, b.yaw, 1e-3);
}

}  // namespace
}  // namespace screed::testing
