// Mean planes, and terrain after a low-pass.
#include "host_sim/physics/terrain/low_pass.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

using std::numbers::pi;

TEST(MeanPlane, IsThatOfLeastSquares) {
  // A checkerboard of an even number of nodes has no part in any plane.
  const HeightField field = HeightField::from_function(40, 20, 0.01, false, [](double x, double y) {
    const auto place = [](double at) { return std::lround(std::floor(at / 0.01)); };
    const bool black = (place(x) + place(y)) % 2 == 0;
    return 0.25 + 0.3 * x - 0.2 * y + (black ? 0.005 : -0.005);
  });
  const MeanPlane plane = mean_plane(field);
  EXPECT_NEAR(plane.height_m, 0.25, 1e-7);
  EXPECT_NEAR(plane.slope_x, 0.3, 2e-3);  // the checkerboard's corners weigh a little
  EXPECT_NEAR(plane.slope_y, -0.2, 4e-3);
}

TEST(MeanPlane, IsLevelOnTerrainThatRepeats) {
  const HeightField field = HeightField::from_function(
      32, 24, 0.01, true, [](double x, double y) { return 0.1 + 0.5 * x + 0.2 * y * y; });
  EXPECT_EQ(mean_plane(field).slope_x, 0.0);
  EXPECT_EQ(mean_plane(field).slope_y, 0.0);
  EXPECT_NEAR(mean_plane(field).height_m,
              static_cast<double>(field.height_sum()) / (32 * 24) * kHeightUnit_m, 1e-12);
}

TEST(LowPass, LeavesAPlaneAsItIs) {
  const HeightField ramp = HeightField::from_function(
      51, 31, 0.01, false, [](double x, double y) { return 0.4 * x - 0.1 * y; });
  const HeightField filtered = low_passed(ramp, 0.05);
  for (int iy = 0; iy < ramp.ny(); ++iy) {
    for (int ix = 0; ix < ramp.nx(); ++ix)
      ASSERT_NEAR(filtered.node(ix, iy), ramp.node(ix, iy), 1) << ix << ", " << iy;
  }
}

TEST(LowPass, TakesAwayWhatIsShortAndKeepsWhatIsLong) {
  // On the ground: 12.5 mm leaves exp(-2 pi^2 / 4) = 0.7 % of stones 25 mm apart, 99.7 % of 1 m.
  constexpr double kLength_m = 1.0;
  const auto wave = [](double period_m) {
    return HeightField::from_function(200, 200, kLength_m / 200, true, [=](double x, double) {
      return 0.01 * std::cos(2.0 * pi * x / period_m);
    });
  };
  const auto highest_m = [](const HeightField& field) {
    double highest = 0.0;
    for (int ix = 0; ix < field.nx(); ++ix)
      highest = std::max(highest, std::abs(field.node(ix, 7) * kHeightUnit_m));
    return highest;
  };
  EXPECT_NEAR(highest_m(low_passed(wave(0.025), 0.0125)), 0.01 * 0.0072, 2e-6);
  EXPECT_NEAR(highest_m(low_passed(wave(1.0), 0.0125)), 0.01 * 0.99692, 2e-6);
}

TEST(LowPass, KeepsGridAndVolume) {
  HeightField field(60, 40, 0.02, false);
  field.set_node(0, 0, 3000000);
  field.set_node(59, 20, -2000000);
  const HeightField filtered = low_passed(field, 0.06);
  EXPECT_EQ(filtered.nx(), 60);
  EXPECT_EQ(filtered.ny(), 40);
  EXPECT_EQ(filtered.spacing_m(), 0.02);
  EXPECT_FALSE(filtered.wrap());
  EXPECT_NEAR(static_cast<double>(filtered.height_sum()), 1e6, 0.5 * 60 * 40);
  EXPECT_TRUE(low_passed(HeightField(20, 20, 0.01, true), 0.05).wrap());
}

TEST(LowPass, RefusesWidthsOutOfRange) {
  const HeightField flat = HeightField::flat(1.0, 0.1);
  for (const double bad : {0.0, -0.05, 101.0, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_THROW(low_passed(flat, bad), InputError) << bad;
}

}  // namespace
}  // namespace screed
