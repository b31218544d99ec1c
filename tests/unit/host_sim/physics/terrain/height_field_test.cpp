// The bilinear surface against closed forms, wrap-around, the slope limit, and refused options.
#include "host_sim/physics/terrain/height_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Samples with a pattern that has neither symmetry nor flat parts.
GreyImage rough_image(int width, int height, int bit_depth) {
  GreyImage image{
      width, height, bit_depth, static_cast<uint16_t>(bit_depth == 16 ? 65535 : 255), {}};
  uint32_t state = 7;
  for (int i = 0; i < width * height; ++i) {
    state = state * 1664525U + 1013904223U;
    image.samples.push_back(static_cast<uint16_t>((state >> 16) & image.max_value));
  }
  return image;
}

double degrees(double gradient) {
  return std::atan(gradient) * 180.0 / std::numbers::pi;
}

TEST(HeightFieldTest, PlaneIsExactToTheUnit) {
  // 96 and -40 units a node: with a spacing of 2^-7 m no rounding at all is left.
  const double spacing = 0x1p-7;
  HeightField field(33, 17, spacing, false);
  for (int iy = 0; iy < 17; ++iy) {
    for (int ix = 0; ix < 33; ++ix) field.set_node(ix, iy, 1000 + 96 * ix - 40 * iy);
  }
  for (int j = 0; j <= 64; ++j) {
    for (int i = 0; i <= 128; ++i) {
      const double u = 0.25 * i;
      const double v = 0.25 * j;
      const SurfacePoint p = field.at(field.x_min() + u * spacing, field.y_min() + v * spacing);
      ASSERT_EQ(p.height / kHeightUnit_m, 1000 + 96 * u - 40 * v);
      ASSERT_EQ(p.gradient_x, 96 * kHeightUnit_m / spacing);
      ASSERT_EQ(p.gradient_y, -40 * kHeightUnit_m / spacing);
    }
  }
}

TEST(HeightFieldTest, SaddleFollowsItsClosedForm) {
  // f = k x y is bilinear itself, so the surface is f everywhere, with gradient (k y, k x).
  const double k = 0.7;
  const HeightField field = HeightField::from_function(
      21, 31, 0.05, false, [k](double x, double y) { return k * x * y; });
  EXPECT_DOUBLE_EQ(field.x_max(), 0.5);
  EXPECT_DOUBLE_EQ(field.y_min(), -0.75);
  for (int j = -20; j <= 20; ++j) {
    for (int i = -20; i <= 20; ++i) {
      const double x = 0.0237 * i;
      const double y = 0.0371 * j;
      const SurfacePoint p = field.at(x, y);
      EXPECT_NEAR(p.height, k * x * y, kHeightUnit_m);
      EXPECT_NEAR(p.gradient_x, k * y, kHeightUnit_m / 0.05);
      EXPECT_NEAR(p.gradient_y, k * x, kHeightUnit_m / 0.05);
    }
  }
}

TEST(HeightFieldTest, EdgesContinueLevelOutside) {
  const HeightField field = HeightField::ramp(2.0, 0.1, 20.0);
  const double rise = std::tan(20.0 * std::numbers::pi / 180.0);
  const SurfacePoint east = field.at(7.0, 0.3);
  EXPECT_NEAR(east.height, rise, kHeightUnit_m);
  EXPECT_EQ(east.gradient_x, 0.0);
  const SurfacePoint north = field.at(0.25, 99.0);
  EXPECT_NEAR(north.height, 0.25 * rise, kHeightUnit_m);
  EXPECT_NEAR(north.gradient_x, rise, 2 * kHeightUnit_m / 0.1);
  EXPECT_EQ(north.gradient_y, 0.0);
  EXPECT_TRUE(field.inside(1.0, -1.0));
  EXPECT_FALSE(field.inside(1.001, 0.0));
  EXPECT_FALSE(field.inside(0.0, kNaN));
}

TEST(HeightFieldTest, SurvivesCoordinatesThatAreNoPlaces) {
  for (const bool wrap : {false, true}) {
    HeightField field(8, 8, 0.1, wrap);
    field.set_node(0, 0, 12345);
    for (const double x : {kNaN, kInfinity, -kInfinity, 1e300, -1e300}) {
      EXPECT_TRUE(std::isfinite(field.at(x, x).height));
      EXPECT_GE(field.max_height_within(x, x, 0.1), field.at(x, x).height);
    }
    EXPECT_EQ(field.at(kNaN, kNaN).height, 12345 * kHeightUnit_m);
  }
}

TEST(HeightFieldTest, WrapRepeatsWithoutASeam) {
  HeightFieldOptions options;
  options.wrap = true;
  options.size_m = 1.4;
  const HeightField field = HeightField::from_image(rough_image(14, 9, 16), options);
  EXPECT_DOUBLE_EQ(field.spacing_m(), 0.1);
  EXPECT_DOUBLE_EQ(field.x_max() - field.x_min(), 1.4);
  EXPECT_DOUBLE_EQ(field.y_max() - field.y_min(), 0.9);
  // Periodic.
  for (const double x : {-0.66, -0.1, 0.0, 0.31, 0.699}) {
    for (const double y : {-0.44, 0.02, 0.449}) {
      const SurfacePoint here = field.at(x, y);
      const SurfacePoint away = field.at(x - 5 * 1.4, y + 3 * 0.9);
      EXPECT_NEAR(here.height, away.height, 1e-12);
      EXPECT_NEAR(here.gradient_x, away.gradient_x, 1e-12);
    }
  }
  // Continuous over the seam: no step larger than the steepest slope allows.
  const double step = 1e-7;
  const double most = 1.01 * step * field.steepest_gradient();
  for (int j = -75; j <= 75; ++j) {
    const double y = 0.0173 * j;
    EXPECT_NEAR(field.at(0.7 - 0.5 * step, y).height, field.at(0.7 + 0.5 * step, y).height, most);
    EXPECT_NEAR(field.at(y, 0.45 - 0.5 * step).height, field.at(y, 0.45 + 0.5 * step).height, most);
    EXPECT_EQ(field.at(-0.7, y).height, field.at(0.7, y).height);
  }
  // Between the last node and the first the surface is a straight line.
  const double y = field.node_y(4);
  const double last = field.at(field.node_x(13), y).height;
  const double first = field.at(field.node_x(0), y).height;
  EXPECT_NEAR(field.at(field.node_x(13) + 0.05, y).height, 0.5 * (last + first), 1e-12);
}

TEST(HeightFieldTest, ImageTopIsNorthAndWhiteIsTheScale) {
  const GreyImage image{3, 2, 8, 255, {0, 0, 255, 51, 0, 0}};
  const HeightField field = HeightField::from_image(image, {.size_m = 4.0, .scale_m = 0.5});
  EXPECT_DOUBLE_EQ(field.spacing_m(), 2.0);
  EXPECT_NEAR(field.at(2.0, 1.0).height, 0.5, kHeightUnit_m);    // top right: north-east
  EXPECT_NEAR(field.at(-2.0, -1.0).height, 0.1, kHeightUnit_m);  // bottom left
  EXPECT_EQ(field.node(2, 1), 1 << 23);
  EXPECT_EQ(field.node(0, 1), 0);
}

TEST(HeightFieldTest, BothBitDepthsSpanTheSameScale) {
  const GreyImage deep{2, 2, 16, 65535, {65535, 0, 0, 32768}};
  const HeightField field = HeightField::from_image(deep, {.size_m = 1.0, .scale_m = 1.0});
  EXPECT_EQ(field.node(0, 1), 1 << 24);
  EXPECT_EQ(field.node(1, 0), std::lround(32768.0 / 65535.0 * 0x1p24));
}

TEST(HeightFieldTest, SteepestGradientIsReachedAndNeverExceeded) {
  for (const bool wrap : {false, true}) {
    HeightFieldOptions options;
    options.wrap = wrap;
    const HeightField field = HeightField::from_image(rough_image(23, 17, 16), options);
    double steepest = 0.0;
    constexpr int kParts = 8;
    // Just inside of each cell's corners, where the gradient is the cell's own, and between.
    for (int j = 0; j < field.cells_y() * kParts; ++j) {
      for (int i = 0; i < field.cells_x() * kParts; ++i) {
        const auto place = [](int k) {
          constexpr double kEdge = 1e-9;
          const int part = k % kParts;
          const int cell = k / kParts;
          return cell + kEdge + part * (1.0 - 2.0 * kEdge) / (kParts - 1);
        };
        const SurfacePoint p = field.at(field.x_min() + place(i) * field.spacing_m(),
                                        field.y_min() + place(j) * field.spacing_m());
        steepest = std::max(steepest, std::hypot(p.gradient_x, p.gradient_y));
      }
    }
    EXPECT_LE(steepest, field.steepest_gradient());
    EXPECT_NEAR(steepest, field.steepest_gradient(), 1e-7);
  }
}

TEST(HeightFieldTest, OneRaisedCornerIsSteepestThere) {
  // At the raised corner both edges rise by the full height: sqrt 2 times it.
  for (const int raised : {0, 1, 2, 3}) {
    HeightField field(2, 2, 0.5, false);
    field.set_node(raised % 2, raised / 2, 1 << 20);
    EXPECT_DOUBLE_EQ(field.steepest_gradient(), std::sqrt(2.0) * 0x1p-4 / 0.5) << raised;
  }
}

TEST(HeightFieldTest, SlopeLimitIsMetAndNotExceeded) {
  for (const double limit : {1.0, 12.5, 25.0, 60.0}) {
    for (const int bit_depth : {8, 16}) {
      const HeightField field = HeightField::from_image(
          rough_image(50, 40, bit_depth), {.size_m = 3.0, .scale_m = 10.0, .max_slope_deg = limit});
      const double wanted = std::tan(limit * std::numbers::pi / 180.0);
      EXPECT_LE(field.steepest_gradient(), wanted);
      EXPECT_GE(field.steepest_gradient(), wanted - 2 * kHeightUnit_m / field.spacing_m());
    }
  }
}

TEST(HeightFieldTest, SlopeLimitLeavesGentleTerrainAlone) {
  const GreyImage image = rough_image(50, 40, 16);
  const HeightField free = HeightField::from_image(image, {.scale_m = 0.001});
  const HeightField limited =
      HeightField::from_image(image, {.scale_m = 0.001, .max_slope_deg = 25.0});
  EXPECT_LT(degrees(free.steepest_gradient()), 25.0);
  for (int iy = 0; iy < 40; ++iy) {
    for (int ix = 0; ix < 50; ++ix) ASSERT_EQ(free.node(ix, iy), limited.node(ix, iy));
  }
}

TEST(HeightFieldTest, SlopeLimitCountsTheSeamOfAWrappedBed) {
  // A staircase to the right: gentle inside, a cliff where it tiles.
  const GreyImage image{4, 2, 8, 255, {0, 10, 20, 30, 0, 10, 20, 30}};
  HeightFieldOptions options{.size_m = 4.0, .scale_m = 25.5, .max_slope_deg = 45.0};
  EXPECT_NEAR(HeightField::from_image(image, options).node(3, 0) * kHeightUnit_m, 3.0, 1e-6);
  options.wrap = true;
  EXPECT_NEAR(HeightField::from_image(image, options).node(3, 0) * kHeightUnit_m, 1.0, 1e-6);
}

TEST(HeightFieldTest, SumOfHeightsIsExact) {
  HeightField field(3, 2, 1.0, true);
  int64_t expected = 0;
  for (int iy = 0; iy < 2; ++iy) {
    for (int ix = 0; ix < 3; ++ix) {
      const Height height = std::numeric_limits<Height>::max() - ix * 3 - iy;
      field.set_node(ix, iy, height);
      expected += height;
    }
  }
  EXPECT_EQ(field.height_sum(), expected);
}

TEST(HeightFieldTest, BoundHoldsAndIsNotFarOff) {
  for (const bool wrap : {false, true}) {
    HeightFieldOptions options;
    options.wrap = wrap;
    HeightField field = HeightField::from_image(rough_image(70, 45, 16), options);
    for (int j = -9; j <= 9; ++j) {
      for (int i = -18; i <= 18; ++i) {
        const double x = 0.171 * i;
        const double y = 0.237 * j;
        const double bound = field.max_height_within(x, y, 0.1);
        for (int k = 0; k < 24; ++k) {
          const double angle = k * std::numbers::pi / 12.0;
          const double r = 0.1 * (k % 3) / 2.0;
          ASSERT_GE(bound, field.at(x + r * std::cos(angle), y + r * std::sin(angle)).height);
        }
      }
    }
    // A peak is seen near it and not from afar; when it is gone, a refresh forgets it.
    field.set_node(35, 22, Height{5} << 24);
    const double x = field.node_x(35);
    const double y = field.node_y(22);
    EXPECT_EQ(field.max_height_within(x + 0.09, y, 0.1), 5.0);
    EXPECT_LT(field.max_height_within(x - 1.4, y, 0.1), 1.0);
    field.set_node(35, 22, 0);
    EXPECT_GE(field.max_height_within(x, y, 0.0), 0.0);
    field.refresh_bounds();
    EXPECT_LT(field.max_height_within(x, y, 0.1), 1.0);
  }
}

TEST(HeightFieldTest, BoundReachesOverTheSeam) {
  HeightField field(70, 45, 0.02, true);
  field.set_node(1, 1, 1 << 24);
  field.set_node(68, 43, 1 << 23);
  EXPECT_EQ(field.max_height_within(field.x_max() - 0.01, field.y_max() - 0.01, 0.05), 1.0);
  EXPECT_EQ(field.max_height_within(field.x_min() + 0.5, field.y_min() - 0.01, 0.05), 0.0);
  EXPECT_EQ(field.max_height_within(field.x_max() - 0.1, field.y_max() - 0.1, 0.05), 0.5);
  field.set_node(1, 1, 0);
  field.refresh_bounds();
  EXPECT_EQ(field.max_height_within(field.x_max() - 0.01, field.y_max() - 0.01, 0.05), 0.5);
}

TEST(HeightFieldTest, FlatAndRampAreWhatTheySay) {
  const HeightField flat = HeightField::flat(1.0, 0.03);
  EXPECT_NEAR(flat.x_max() - flat.x_min(), 1.0, 1e-12);
  EXPECT_EQ(flat.nx(), 34);
  EXPECT_EQ(flat.steepest_gradient(), 0.0);
  const HeightField ramp = HeightField::ramp(1.0, 0.03, -15.0);
  EXPECT_NEAR(degrees(ramp.steepest_gradient()), 15.0, 1e-3);
  EXPECT_LT(ramp.at(0.2, 0.0).gradient_x, 0.0);
}

void expect_refused(const HeightFieldOptions& options, const std::string& name,
                    const std::string& allowed) {
  try {
    HeightField::from_image(rough_image(5, 5, 8), options);
    ADD_FAILURE() << name << " was accepted";
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(name + " = "), std::string::npos) << message;
    EXPECT_NE(message.find("allowed: " + allowed), std::string::npos) << message;
  }
}

TEST(HeightFieldTest, RefusesOptionsOutOfRange) {
  for (const double bad : {kNaN, kInfinity, -kInfinity, -1.0, 0.0}) {
    expect_refused({.size_m = bad}, "size_m", "0.1 to 1000");
    expect_refused({.scale_m = bad}, "scale_m", "0.0001 to 100");
    expect_refused({.max_slope_deg = bad}, "max_slope_deg", "0.1 to 89");
  }
  expect_refused({.size_m = 1000.1}, "size_m", "0.1 to 1000");
  expect_refused({.scale_m = 101.0}, "scale_m", "0.0001 to 100");
  expect_refused({.max_slope_deg = 90.0}, "max_slope_deg", "0.1 to 89");
}

TEST(HeightFieldTest, RefusesGridsAndHeightsOutOfRange) {
  EXPECT_THROW(HeightField::from_image(rough_image(1, 5, 8), {}), InputError);
  EXPECT_THROW(HeightField(2, 16385, 0.1, false), InputError);
  EXPECT_THROW(HeightField(2, 2, 0.0, false), InputError);
  EXPECT_THROW(HeightField(2, 2, kNaN, false), InputError);
  EXPECT_THROW(HeightField::flat(1.0, 0.51), InputError);
  EXPECT_THROW(HeightField::flat(1.0, 1e-5), InputError);
  EXPECT_THROW(HeightField::ramp(1.0, 0.1, 90.0), InputError);
  for (const double bad : {kNaN, kInfinity, 127.1, -127.1}) {
    EXPECT_THROW(
        HeightField::from_function(2, 2, 1.0, false, [bad](double, double) { return bad; }),
        InputError);
  }
}

// A Gaussian turns a cosine into the same cosine, weakened by exp(-(k sigma)^2 / 2).
TEST(HeightFieldSmoothing, WeakensAWaveAsAGaussianDoes) {
  GreyImage image;
  image.width = 64;
  image.height = 64;
  image.bit_depth = 16;
  image.max_value = 65535;
  for (int row = 0; row < 64; ++row) {
    for (int column = 0; column < 64; ++column) {
      const double wave = std::cos(2.0 * std::numbers::pi * 4.0 * column / 64.0);
      image.samples.push_back(static_cast<uint16_t>(std::lround(32767.0 + 30000.0 * wave)));
    }
  }
  HeightFieldOptions options;
  options.size_m = 6.4;
  options.scale_m = 1.0;
  options.wrap = true;
  options.smoothing_m = 0.2;
  const HeightField field = HeightField::from_image(image, options);
  const double k = 2.0 * std::numbers::pi * 4.0 / 6.4;
  const double amplitude = 30000.0 / 65535.0 * std::exp(-0.5 * k * k * 0.2 * 0.2);
  const double crest = field.node(0, 10) * kHeightUnit_m;
  const double trough = field.node(8, 10) * kHeightUnit_m;
  EXPECT_NEAR(0.5 * (crest - trough), amplitude, 1e-3 * amplitude);
  EXPECT_NEAR(0.5 * (crest + trough), 32767.0 / 65535.0, 1e-4);
}

// What is level stays level, also at edges that do not wrap.
TEST(HeightFieldSmoothing, KeepsALevelField) {
  GreyImage image;
  image.width = 20;
  image.height = 10;
  image.bit_depth = 8;
  image.max_value = 255;
  image.samples.assign(200, 100);
  HeightFieldOptions options;
  options.smoothing_m = 0.5;
  const HeightField field = HeightField::from_image(image, options);
  for (int iy = 0; iy < 10; ++iy) {
    for (int ix = 0; ix < 20; ++ix) EXPECT_NEAR(field.node(ix, iy), field.node(0, 0), 1);
  }
}

}  // namespace
}  // namespace screed
