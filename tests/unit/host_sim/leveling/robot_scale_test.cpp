// Surfaces whose figures follow from closed forms: plane, wave, step.
#include "host_sim/leveling/robot_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

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

}  // namespace
}  // namespace screed
