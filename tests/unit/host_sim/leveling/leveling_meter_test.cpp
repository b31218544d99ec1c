// Measures of leveling: points of a curve, robot scale, transport.
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/world_setup.h"

namespace screed {

namespace {

// Points of a curve from known surfaces.

/// A wave over a bed that repeats.
HeightField wave(double amplitude_m) {
  return HeightField::from_function(120, 60, 0.01, true, [&](double x, double /*y*/) {
    return amplitude_m * std::cos(2.0 * std::numbers::pi * x / 0.6);
  });
}

LevelingCost cost(double time_s, double energy_j) {
  LevelingCost cost;
  cost.time_s = time_s;
  cost.distance_m = 2.5;
  cost.energy_j = energy_j;
  cost.traversability = {0.125, 0.25, 0.375, 0.0625, 0.75, 0.5};
  return cost;
}

TEST(LevelingMeter, ProgressCountsFromTheFirstSurface) {
  LevelingMeter meter(5.0);
  const LevelingPoint start = meter.measure(wave(0.02), cost(0.0, 0.0), true);
  EXPECT_EQ(start.progress, 0.0);
  EXPECT_TRUE(std::isnan(start.transport_per_joule)) << "no energy was spent yet";
  const LevelingPoint later = meter.measure(wave(0.015), cost(60.0, 200.0), true);
  EXPECT_NEAR(later.progress, 0.25, 1e-5);
  EXPECT_DOUBLE_EQ(later.transport_per_joule, (start.transport - later.transport) / 200.0);
  EXPECT_NEAR(later.relief / start.relief, 0.75, 1e-5);
  EXPECT_NEAR(later.height_deviation, 0.015 / std::sqrt(2.0), 1e-7);
  const LevelingPoint worse = meter.measure(wave(0.03), cost(90.0, 300.0), true);
  EXPECT_NEAR(worse.progress, -0.5, 1e-5);
  EXPECT_LT(worse.transport_per_joule, 0.0);
}

TEST(LevelingMeter, WithoutTransportTheRestIsThere) {
  LevelingMeter meter(5.0);
  const LevelingPoint point = meter.measure(wave(0.02), cost(30.0, 100.0), false);
  EXPECT_TRUE(std::isnan(point.transport));
  EXPECT_TRUE(std::isnan(point.transport_error));
  EXPECT_TRUE(std::isnan(point.transport_squared));
  EXPECT_TRUE(std::isnan(point.progress));
  EXPECT_EQ(point.time, 30.0);
  EXPECT_EQ(point.distance, 2.5);
  EXPECT_EQ(point.energy, 100.0);
  EXPECT_EQ(point.stuck, 0.125);
  EXPECT_EQ(point.tilted, 0.25);
  EXPECT_EQ(point.off_site, 0.375);
  EXPECT_EQ(point.returning, 0.0625);
  EXPECT_EQ(point.visited, 0.75);
  EXPECT_EQ(point.slip, 0.5);
  EXPECT_GT(point.relief, 0.01);
  EXPECT_GT(point.robot_scale_flatness, point.flatness);
}

TEST(LevelingMeter, FromLevelGroundThereIsNoProgress) {
  LevelingMeter meter(5.0);
  const LevelingPoint start = meter.measure(HeightField::flat(1.0, 0.1), cost(0.0, 0.0), true);
  EXPECT_EQ(start.transport, 0.0);
  EXPECT_TRUE(std::isnan(start.progress));
}

// Surfaces whose figures follow from closed forms: plane, wave, step.

using std::numbers::pi;

constexpr double kFlat_deg = 5.0;

/// What the low-pass keeps of a wave of this length: exp(-(2 pi sigma / L)^2 / 2).
double gain(double length_m) {
  return std::exp(-0.5 * std::pow(2.0 * pi * kRobotScale_m / length_m, 2.0));
}

TEST(RobotScale, PartsAWaveByItsLength) {
  constexpr double kAmplitude_m = 0.02;
  for (const double length_m : {0.1, 0.25, 0.5, 1.0}) {
    const HeightField wave =
        HeightField::from_function(200, 20, 0.005, true, [&](double x, double /*y*/) {
          return 0.3 + kAmplitude_m * std::cos(2.0 * pi * x / length_m);
        });
    const double rms = kAmplitude_m / std::sqrt(2.0);
    const RobotScaleFigures figures = robot_scale_figures(wave, kFlat_deg);
    EXPECT_NEAR(figures.relief_m, rms * gain(length_m), 3e-6) << length_m;
    EXPECT_NEAR(figures.roughness_m, rms * (1.0 - gain(length_m)), 3e-6) << length_m;
  }
}

// A plane of slope s over a length L: s L / sqrt(12); what is no plane adds in squares.
TEST(RobotScale, ASlantIsNoReliefAndNotLevel) {
  constexpr double kSlope = 0.05;
  constexpr double kAmplitude_m = 0.02;
  const HeightField slant =
      HeightField::from_function(201, 101, 0.01, false, [&](double x, double y) {
        return 3.0 + kSlope * x + kAmplitude_m * std::cos(2.0 * pi * y / 0.5);
      });
  const RobotScaleFigures figures = robot_scale_figures(slant, kFlat_deg);
  const double plane = kSlope * 2.0 / std::sqrt(12.0);
  const double wave = kAmplitude_m / std::sqrt(2.0) * gain(0.5);
  EXPECT_NEAR(figures.relief_m, wave, 0.01 * wave);
  EXPECT_NEAR(figures.level_deviation_m, std::hypot(plane, wave), 0.01 * plane);
  const HeightField level = HeightField::flat(1.0, 0.01);
  EXPECT_EQ(robot_scale_figures(level, kFlat_deg).level_deviation_m, 0.0);
}

TEST(RobotScale, AWaveIsFlatAroundItsCrestsAndTroughs) {
  // Slope of the low-passed wave: A g k sin(k x), within tan(limit) on 2/pi asin(tan(limit) / A g
  // k) of its length.
  constexpr double kAmplitude_m = 0.03;
  constexpr double kLength_m = 1.0;
  const HeightField wave = HeightField::from_function(
      1000, 4, 0.001, true,
      [&](double x, double /*y*/) { return kAmplitude_m * std::sin(2.0 * pi * x / kLength_m); });
  const double steepest = kAmplitude_m * gain(kLength_m) * 2.0 * pi / kLength_m;
  const double expected = 2.0 / pi * std::asin(std::tan(kFlat_deg * pi / 180.0) / steepest);
  EXPECT_NEAR(robot_scale_figures(wave, kFlat_deg).flatness, expected, 0.005);
}

TEST(RobotScale, RutsBelowTheScaleLeaveTheGroundFlat) {
  // Cells of 22 degrees and more, and after the low-pass next to nothing.
  const HeightField ruts = HeightField::from_function(
      200, 20, 0.005, true,
      [&](double x, double /*y*/) { return 0.004 * std::cos(2.0 * pi * x / 0.05); });
  const RobotScaleFigures figures = robot_scale_figures(ruts, 1.0);
  EXPECT_EQ(figures.flatness, 1.0);
  EXPECT_LT(figures.relief_m, 1e-6);
  EXPECT_NEAR(figures.roughness_m, 0.004 / std::sqrt(2.0), 3e-6);
}

TEST(RobotScale, APlaneHasNoReliefAndKeepsItsSlope) {
  const HeightField ramp = HeightField::ramp(1.5, 0.01, 5.0);
  const RobotScaleFigures figures = robot_scale_figures(ramp, 5.0);
  EXPECT_LT(figures.relief_m, kHeightUnit_m);
  EXPECT_LT(figures.roughness_m, kHeightUnit_m);
  EXPECT_EQ(figures.flatness, 1.0);
  EXPECT_EQ(robot_scale_figures(ramp, 4.99).flatness, 0.0);
}

// Slopes of 3 and 4 per cent along the axes are one of 5 per cent, 2.862 degrees, whichever way
// they fall.
TEST(RobotScale, APlaneIsAsSteepAsBothItsSlopesTogether) {
  for (const double slope_x : {0.03, -0.03}) {
    for (const double slope_y : {0.04, -0.04}) {
      const HeightField plane = HeightField::from_function(
          101, 51, 0.01, false, [&](double x, double y) { return slope_x * x + slope_y * y; });
      EXPECT_EQ(robot_scale_figures(plane, 2.87).flatness, 1.0) << slope_x << " " << slope_y;
      EXPECT_EQ(robot_scale_figures(plane, 2.85).flatness, 0.0) << slope_x << " " << slope_y;
      // Uniform along each axis: (slope L)^2 / 12 of each.
      const double expected = std::hypot(0.03 * 1.0, 0.04 * 0.5) / std::sqrt(12.0);
      EXPECT_NEAR(robot_scale_figures(plane, 2.87).level_deviation_m, expected, 0.03 * expected);
    }
  }
}

// On a slant that a wave runs down, their slopes add, whichever way both go.
TEST(RobotScale, AWaveOnASlantIsFlatWhereBothSlopesTogetherAre) {
  constexpr double kAmplitude_m = 0.02;
  constexpr double kLength_m = 1.0;
  constexpr double kSlope = 0.05;
  // The slope is kSlope + k cos, k = A g 2 pi / L: never below -limit, and within the limit where
  // the cosine is (limit - kSlope) / k or less.
  const double k = kAmplitude_m * gain(kLength_m) * 2.0 * pi / kLength_m;
  const double limit = std::tan(kFlat_deg * pi / 180.0);
  const double expected = 1.0 - std::acos((limit - kSlope) / k) / pi;
  for (const double way_deg : {0.0, 45.0, 90.0, 135.0}) {
    const double c = std::cos(way_deg * pi / 180.0);
    const double s = std::sin(way_deg * pi / 180.0);
    const HeightField field =
        HeightField::from_function(201, 201, 0.02, false, [&](double x, double y) {
          const double at = c * x + s * y;
          return kSlope * at + kAmplitude_m * std::sin(2.0 * pi * at / kLength_m);
        });
    EXPECT_NEAR(robot_scale_figures(field, kFlat_deg).flatness, expected, 0.02) << way_deg;
  }
}

TEST(RobotScale, AStepBecomesAnErrorFunction) {
  // A bed of two levels that repeats: the low-pass leaves erf(x / (sigma sqrt 2)) at each step. On
  // a bed much longer than sigma the mean square of what it takes away is 2 steps of h^2 / 4 x
  // integral of (sign(x) - erf(x / (sigma sqrt 2)))^2 = h^2 / 4 x 2 sigma sqrt 2 c, with c =
  // integral from 0 of erfc^2 = (2 - sqrt 2) / sqrt pi.
  constexpr double kStep_m = 0.04;
  constexpr double kLength_m = 2.0;
  const HeightField step = HeightField::from_function(
      1000, 4, kLength_m / 1000, true,
      [&](double x, double /*y*/) { return x < -0.0005 ? 0.0 : kStep_m; });
  const double c = (2.0 - std::sqrt(2.0)) / std::sqrt(pi);
  const double square =
      2.0 * kStep_m * kStep_m / 4.0 * 2.0 * kRobotScale_m * std::sqrt(2.0) * c / kLength_m;
  const RobotScaleFigures figures = robot_scale_figures(step, kFlat_deg);
  EXPECT_NEAR(figures.roughness_m, std::sqrt(square), 2e-3 * std::sqrt(square));
  // Slope of the low-passed step: h / (sigma sqrt(2 pi)) exp(-x^2 / (2 sigma^2)).
  const double top = kStep_m / (kRobotScale_m * std::sqrt(2.0 * pi));
  const double reach_m =
      kRobotScale_m * std::sqrt(2.0 * std::log(top / std::tan(kFlat_deg * pi / 180.0)));
  EXPECT_NEAR(figures.flatness, 1.0 - 4.0 * reach_m / kLength_m, 0.004);
}

TEST(RobotScale, RefusesALimitThatIsNone) {
  const HeightField flat = HeightField::flat(1.0, 0.1);
  EXPECT_THROW(robot_scale_figures(flat, -0.1), InputError);
  EXPECT_THROW(robot_scale_figures(flat, 90.0), InputError);
}

// Transports whose least work is known: shifted blocks, waves, and every plan of a small problem.

using std::numbers::pi;

constexpr double kSpacing_m = 0.01;

Height units(double height_m) {
  return static_cast<Height>(std::lround(height_m / kHeightUnit_m));
}

/// Raises the nodes x..x+9, y..y+9: a hundredth of a square metre.
void raise_square(HeightField& field, int x, int y, double by_m) {
  for (int iy = y; iy < y + 10; ++iy) {
    for (int ix = x; ix < x + 10; ++ix) field.set_node(ix, iy, field.node(ix, iy) + units(by_m));
  }
}

constexpr double kHeap_m = 0x1p-5;  // 31 mm, without rounding
constexpr double kVolume_m3 = 0.1 * 0.1 * kHeap_m;

/// One square of ground too high, another one too low by as much.
HeightField heap_and_pit(int heap_x, int heap_y, int pit_x, int pit_y, bool wrap) {
  HeightField field(120, 80, kSpacing_m, wrap);
  raise_square(field, heap_x, heap_y, kHeap_m);
  raise_square(field, pit_x, pit_y, -kHeap_m);
  return field;
}

TEST(Transport, AShiftedBlockTakesItsVolumeTimesTheDistance) {
  // Blocks of 10 nodes: heap and pit are one each.
  const GroundBlocks ground = ground_blocks(heap_and_pit(10, 20, 70, 60, false), 12);
  ASSERT_EQ(ground.blocks.size(), 96U);
  const double distance_m = std::hypot(0.6, 0.4);
  EXPECT_NEAR(least_transport(ground), kVolume_m3 * distance_m, 1e-8 * kVolume_m3);
  EXPECT_NEAR(least_squared_transport(ground), kVolume_m3 * distance_m * distance_m,
              1e-8 * kVolume_m3);
}

TEST(Transport, OnWrappedGroundTheWayMayLeadOverTheEdge) {
  const HeightField field = heap_and_pit(10, 0, 110, 70, true);
  const double distance_m = std::hypot(0.2, 0.1);
  EXPECT_NEAR(least_transport(ground_blocks(field, 12)), kVolume_m3 * distance_m,
              1e-8 * kVolume_m3);
  const HeightField open = heap_and_pit(10, 0, 110, 70, false);
  EXPECT_NEAR(least_transport(ground_blocks(open, 12)), kVolume_m3 * std::hypot(1.0, 0.7),
              1e-8 * kVolume_m3);
}

TEST(Transport, ABlockBetweenTheGridsLinesIsWithinTheBound) {
  for (const int off : {1, 3, 5, 8}) {
    const GroundBlocks ground = ground_blocks(heap_and_pit(10 + off, 20, 70, 60 - off, false), 12);
    const double distance_m = std::hypot(0.6 - 0.01 * off, 0.4 - 0.01 * off);
    EXPECT_LE(std::abs(least_transport(ground) - kVolume_m3 * distance_m), ground.w1_error) << off;
    EXPECT_LT(ground.w1_error, 2.0 * kVolume_m3 * 0.1) << off;
  }
}

TEST(Transport, AWaveFlowsFromItsCrestsToItsTroughs) {
  // Ground flows from the crests of A cos(k x) to its troughs; the flow is A sin(k x) / k, and the
  // work the integral of its magnitude, on average 2 A / (pi k).
  constexpr double kAmplitude_m = 0.02;
  constexpr double kLength_m = 0.6;
  for (const bool wrap : {true, false}) {
    // Two whole waves, troughs at both edges: no ground would flow over them anyway.
    const HeightField wave = HeightField::from_function(
        240, 40, 0.005, wrap,
        [&](double x, double /*y*/) { return kAmplitude_m * std::cos(2.0 * pi * x / kLength_m); });
    const double k = 2.0 * pi / kLength_m;
    const double expected = kAmplitude_m * 2.0 / (pi * k) * (240 * 0.005) * (40 * 0.005);
    const GroundBlocks ground = ground_blocks(wave, 48);
    EXPECT_NEAR(least_transport(ground), expected, 0.01 * expected) << wrap;
    EXPECT_LE(std::abs(least_transport(ground) - expected), ground.w1_error) << wrap;
  }
}

TEST(Transport, LevelGroundNeedsNone) {
  HeightField level(120, 80, kSpacing_m, false);
  for (int iy = 0; iy < level.ny(); ++iy) {
    for (int ix = 0; ix < level.nx(); ++ix) level.set_node(ix, iy, 4711);
  }
  const GroundBlocks ground = ground_blocks(level);
  EXPECT_EQ(least_transport(ground), 0.0);
  EXPECT_EQ(least_squared_transport(ground), 0.0);
  EXPECT_EQ(ground.w1_error, 0.0);
}

TEST(Transport, DoesNotDependOnWhereHeightsCountFrom) {
  HeightField low = heap_and_pit(13, 22, 71, 60, false);
  HeightField high = low;
  for (int iy = 0; iy < high.ny(); ++iy) {
    for (int ix = 0; ix < high.nx(); ++ix) high.set_node(ix, iy, high.node(ix, iy) + units(100.0));
  }
  EXPECT_DOUBLE_EQ(least_transport(ground_blocks(high)), least_transport(ground_blocks(low)));
}

TEST(Transport, IsTheBestOfAllAssignments) {
  // Equal heaps and equal pits: the best plan is one to one (Birkhoff), so that all of them can be
  // tried.
  WorldRandom random(7, "transport test");
  for (int trial = 0; trial < 20; ++trial) {
    GroundBlocks ground;
    ground.width_m = 1.0;
    ground.length_m = 0.8;
    ground.wrap = trial % 2 == 1;
    constexpr int kHeaps = 6;
    for (int i = 0; i < 2 * kHeaps; ++i) {
      ground.blocks.push_back(
          {random.uniform(-0.5, 0.5), random.uniform(-0.4, 0.4), i < kHeaps ? 0.001 : -0.001});
    }
    const auto distance = [&](int heap, int pit) {
      const GroundBlock& a = ground.blocks[static_cast<size_t>(heap)];
      const GroundBlock& b =
          ground.blocks[static_cast<std::size_t>(kHeaps) + static_cast<std::size_t>(pit)];
      double dx = std::abs(a.x_m - b.x_m);
      double dy = std::abs(a.y_m - b.y_m);
      if (ground.wrap) {
        dx = std::min(dx, ground.width_m - dx);
        dy = std::min(dy, ground.length_m - dy);
      }
      return std::hypot(dx, dy);
    };
    std::vector<int> pit_of = {0, 1, 2, 3, 4, 5};
    double best = std::numeric_limits<double>::infinity();
    double best_squared = best;
    do {
      double sum = 0.0;
      double squares = 0.0;
      for (int heap = 0; heap < kHeaps; ++heap) {
        const double d = distance(heap, pit_of[static_cast<size_t>(heap)]);
        sum += d;
        squares += d * d;
      }
      best = std::min(best, sum);
      best_squared = std::min(best_squared, squares);
    } while (std::next_permutation(pit_of.begin(), pit_of.end()));
    EXPECT_NEAR(least_transport(ground), 0.001 * best, 1e-10) << trial;
    EXPECT_NEAR(least_squared_transport(ground), 0.001 * best_squared, 1e-10) << trial;
  }
}

TEST(Transport, TheCoarseGridIsWithinItsBoundAndMuchCloser) {
  // Hills of four lengths, solved on every node and on the grid that runs use.
  const HeightField hills = HeightField::from_function(48, 40, 0.03, true, [](double x, double y) {
    const double k = 2.0 * pi / 1.44;
    const double l = 2.0 * pi / 1.2;
    return 0.02 * std::sin(k * x) * std::cos(l * y) + 0.012 * std::cos(2.0 * k * x + l * y) +
           0.006 * std::sin(3.0 * k * x - 4.0 * l * y) +
           0.003 * std::cos(7.0 * k * x + 5.0 * l * y);
  });
  const GroundBlocks nodes = ground_blocks(hills, 48);
  EXPECT_EQ(nodes.w1_error, 0.0);
  const double exact = least_transport(nodes);
  const GroundBlocks coarse = ground_blocks(hills);
  EXPECT_LE(std::abs(least_transport(coarse) - exact), coarse.w1_error);
  EXPECT_NEAR(least_transport(coarse), exact, 0.005 * exact);
  EXPECT_NEAR(least_squared_transport(coarse), least_squared_transport(nodes), 0.05 * exact);
}

TEST(Transport, OnTheElevationModelTheGridAgreesWithOneTwiceAsFine) {
  const HeightField terrain = make_terrain(read_experiment("soft_bed"));
  const GroundBlocks coarse = ground_blocks(terrain);
  const GroundBlocks fine = ground_blocks(terrain, 2 * kTransportBlocks);
  const double expected = least_transport(fine);
  EXPECT_NEAR(least_transport(coarse), expected, 0.0012 * expected);
  const double squared = least_squared_transport(fine);
  EXPECT_NEAR(least_squared_transport(coarse), squared, 0.034 * squared);
  EXPECT_NEAR(coarse.w1_error, 0.0925 * expected, 0.0005 * expected);
}

TEST(Transport, RefusesAGridOfNoBlocks) {
  EXPECT_THROW(ground_blocks(HeightField::flat(1.0, 0.1), 0), InputError);
}

}  // namespace

}  // namespace screed
