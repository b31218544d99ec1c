// A wheel on soil against the limit of an infinitely fine grid, against measurements, and over its
// own rut. The limit itself against figures that were computed elsewhere.
#include "host_sim/soil_validation/wheel_testbed.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/core/errors.h"
#include "paths.h"
#include "tests/sanitizers.h"

namespace screed {
namespace {

constexpr NormalStress kBoth[] = {NormalStress::kRadial, NormalStress::kVertical};
constexpr double kSlips[] = {0.0, 0.2, 0.4};

const char* name(NormalStress stress) {
  return stress == NormalStress::kRadial ? "radial" : "vertical";
}

WheelTest wheel_on(const char* soil, double slip, NormalStress stress, double cell_m) {
  WheelTest test;
  test.soil = soil_preset(soil);
  test.wheel.slip = slip;
  test.options.normal_stress = stress;
  test.cell_m = cell_m;
  return test;
}

// r 30 mm, width 25 mm, 3 N on viper. At slip 0.2 the vertical reference was computed with the
// shear displacement's length always growing (0.25393 N, 0.027384 Nm); here its direction counts,
// and the front of the contact, where the rim still pushes forward, takes from it.
TEST(SoilWheelLimitTest, AgreesWithPublishedFigures) {
  constexpr struct {
    NormalStress stress;
    double slip;
    double sinkage_mm;
    double drawbar_pull_n;
    double torque_nm;
  } kKnown[] = {
      {NormalStress::kVertical, 0.0, 7.0558, -0.20736, 0.013861},
      {NormalStress::kVertical, 0.4, 7.0558, 0.77126, 0.042492},
      {NormalStress::kRadial, 0.0, 6.9930, -0.50217, 0.006271},
      {NormalStress::kRadial, 0.2, 6.8951, -0.10254, 0.017935},
      {NormalStress::kRadial, 0.4, 6.7847, 0.29985, 0.029663},
  };
  for (const auto& known : kKnown) {
    RollingWheel wheel;
    wheel.slip = known.slip;
    const WheelReaction limit = wheel_limit(wheel, soil_preset("viper"), known.stress);
    EXPECT_NEAR(limit.sinkage_m * 1e3, known.sinkage_mm, 1e-4) << name(known.stress) << known.slip;
    EXPECT_NEAR(limit.drawbar_pull_n, known.drawbar_pull_n, 4e-5);
    EXPECT_NEAR(limit.torque_nm, known.torque_nm, 2e-6);
  }
}

// A wheel that is nearly rigid soil's own: E alone, closed form. p = E (depth): the parabola's
// area gives load = 4/3 E w sqrt(2 r) z^1.5 for depths much smaller than the radius.
TEST(SoilWheelLimitTest, ElasticSoilInClosedForm) {
  SoilParameters soil = soil_preset("viper");
  soil.k_phi = 1e12;  // never reached
  soil.exponent = 1.0;
  soil.friction_deg = 0.0;
  RollingWheel wheel;
  const double z =
      std::pow(0.75 * wheel.load_n /
                   (soil.elastic_pa_per_m * wheel.width_m * std::sqrt(2.0 * wheel.radius_m)),
               2.0 / 3.0);
  const WheelReaction limit = wheel_limit(wheel, soil, NormalStress::kVertical);
  EXPECT_NEAR(limit.sinkage_m / z, 1.0, 0.005);
  EXPECT_NEAR(limit.drawbar_pull_n, 0.0, 1e-9);
  EXPECT_NEAR(limit.rut_m, 0.0, 1e-9);
}

TEST(SoilWheelLimitTest, RefusesALoadThatSinksToTheAxle) {
  RollingWheel wheel;
  wheel.load_n = 1e5;
  EXPECT_THROW(wheel_limit(wheel, soil_preset("soft"), NormalStress::kRadial), InputError);
}

// Required: sinkage 2 % at 5 mm, 1 % at 2.5 mm; drawbar pull 0.005 of the load.
TEST(SoilWheelTest, SinkageAndDrawbarPullAreThoseOfTheLimit) {
  for (const double cell : {0.005, 0.0025}) {
    const double sinkage_error = cell == 0.005 ? 0.02 : 0.01;
    for (const NormalStress stress : kBoth) {
      for (const double slip : kSlips) {
        const WheelTest test = wheel_on("viper", slip, stress, cell);
        const WheelReaction limit = wheel_limit(test.wheel, test.soil, stress);
        const WheelTestResult result = run_wheel(test);
        const WheelPass& pass = result.passes[0];
        EXPECT_NEAR(pass.sinkage_m / limit.sinkage_m, 1.0, sinkage_error)
            << name(stress) << ", slip " << slip << ", cell " << cell;
        EXPECT_NEAR(pass.drawbar_pull_n, limit.drawbar_pull_n, 0.005 * test.wheel.load_n)
            << name(stress) << ", slip " << slip << ", cell " << cell;
        EXPECT_NEAR(pass.torque_nm, limit.torque_nm, 0.01 * test.wheel.load_n * 0.03)
            << name(stress) << ", slip " << slip << ", cell " << cell;
        EXPECT_NEAR(pass.load_n, test.wheel.load_n, 0.01 * test.wheel.load_n);
        EXPECT_NEAR(pass.rut_m / limit.rut_m, 1.0, 0.01);
        EXPECT_EQ(result.balance.error(), 0);
      }
    }
  }
}

// The place of the track on the grid does not matter, its direction a little: at 45 degrees the
// sinkage is 2.2 % and the drawbar pull 0.0135 of the load off at 5 mm (nothing is required of
// yaw).
TEST(SoilWheelTest, PlaceAndYawOnTheGridDoNotMatter) {
  for (const double yaw_deg : {0.0, 17.0, 45.0, 90.0, -63.0, 180.0}) {
    if (testing::kSanitized && yaw_deg != 17.0) continue;  // the rest repeats it elsewhere
    const bool square = std::fmod(yaw_deg, 90.0) == 0.0;
    for (const double offset : {0.0, 0.0013, 0.0025}) {
      WheelTest test = wheel_on("viper", 0.2, NormalStress::kRadial, 0.005);
      test.yaw_rad = yaw_deg * 0.017453292519943295;
      test.offset_m = offset;
      const WheelReaction limit = wheel_limit(test.wheel, test.soil, NormalStress::kRadial);
      const WheelPass pass = run_wheel(test).passes[0];
      EXPECT_NEAR(pass.sinkage_m / limit.sinkage_m, 1.0, square ? 0.02 : 0.025)
          << yaw_deg << ", " << offset;
      EXPECT_NEAR(pass.drawbar_pull_n, limit.drawbar_pull_n,
                  (square ? 0.0065 : 0.015) * test.wheel.load_n)
          << yaw_deg << ", " << offset;
      EXPECT_NEAR(pass.side_force_n, 0.0, 0.005 * test.wheel.load_n) << yaw_deg << ", " << offset;
    }
  }
}

// Along its own rut the wheel meets soil that gives only at E until it is as deep as before: it
// sinks on, but by a third of the first pass. The limit of that, too, is known; the engine's second
// pass stays within 2 % of its depth (drawbar pull: 0.014 of the load off with radial stress, see
// docs/measurements/soil.md).
TEST(SoilWheelTest, ASecondPassSinksMuchLess) {
  for (const NormalStress stress : kBoth) {
    WheelTest test = wheel_on("viper", 0.2, stress, 0.005);
    test.passes = 2;
    const std::vector<WheelPass> passes = run_wheel(test).passes;
    WheelReaction limit = wheel_limit(test.wheel, test.soil, stress);
    EXPECT_NEAR(passes[0].rut_m / limit.rut_m, 1.0, 0.02);  // it persists
    test.wheel.rut_m = limit.rut_m;
    limit = wheel_limit(test.wheel, test.soil, stress);
    EXPECT_NEAR(passes[1].sinkage_m / limit.sinkage_m, 1.0, 0.02) << name(stress);
    EXPECT_LT(passes[1].sinkage_m - passes[0].rut_m, 0.4 * passes[0].sinkage_m) << name(stress);
    EXPECT_GT(passes[1].sinkage_m, passes[0].rut_m) << name(stress);
  }
}

TEST(SoilWheelTest, StepSizeDoesNotMatterOnStiffSoil) {
  WheelTest test = wheel_on("lete_sand", 0.2, NormalStress::kRadial, 0.005);  // E = 4e8
  const double limit = wheel_limit(test.wheel, test.soil, NormalStress::kRadial).sinkage_m;
  for (const double step : {0.0005, 0.001, 0.002, 0.004}) {
    test.step_s = step;
    const WheelPass pass = run_wheel(test).passes[0];
    EXPECT_NEAR(pass.sinkage_m, limit, 0.06 * limit) << step;
    EXPECT_LT(pass.ripple_m, 0.3 * limit) << step;
    EXPECT_NEAR(pass.load_n, test.wheel.load_n, 0.05 * test.wheel.load_n) << step;
  }
}

// Required: sinkage within 35 % at slip 0.2 to 0.6 after fitting slip_sinkage alone. The drawbar
// pull is not asserted: it is 36 to 149 % too high (docs/measurements/soil.md says so).
TEST(SoilWheelTest, DingsWheelSinksAsMeasured) {
  const std::vector<MeasuredWheel> rows = read_measured_wheels(
      std::string(kDataFolder) + "/soil/single_wheel_ding2011.csv", "ding2011_smooth");
  ASSERT_EQ(rows.size(), 6U);
  SoilParameters soil = soil_preset("ding_2011");
  soil.slip_sinkage = fit_slip_sinkage(rows, soil, NormalStress::kRadial, 0.2, 0.6);
  EXPECT_NEAR(soil.slip_sinkage, 0.27, 0.011);
  for (const MeasuredWheel& row : rows) {
    if (row.wheel.slip < 0.19) continue;
    WheelTest test;
    test.wheel = row.wheel;
    test.soil = soil;
    test.mass_kg = 8.0;
    test.cell_m = 0.01;
    EXPECT_NEAR(run_wheel(test).passes[0].sinkage_m / row.sinkage_m, 1.0, 0.35) << row.wheel.slip;
  }
}

TEST(SoilWheelTest, RefusesWhatMakesNoSense) {
  WheelTest test = wheel_on("viper", 1.0, NormalStress::kRadial, 0.005);
  EXPECT_THROW(run_wheel(test), InputError);
  EXPECT_THROW(read_measured_wheels("/nowhere.csv", ""), InputError);
}

}  // namespace
}  // namespace screed
