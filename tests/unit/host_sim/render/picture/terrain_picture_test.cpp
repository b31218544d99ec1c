// Colours and contour lines of terrain, pixel by pixel.
#include "host_sim/render/picture/terrain_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/render/picture/map_frame.h"

namespace screed {
namespace {

constexpr double kBed_m = 1.5;

/// What a picture of a bed shows at a place of it.
class Shown {
 public:
  explicit Shown(Canvas canvas)
      : canvas_(std::move(canvas)), rgb_(canvas_.rgb()), frame_(canvas_, kGround, 0.0) {}

  Color at(double x_m, double y_m) const {
    const Pixel pixel = frame_.to_pixel(x_m, y_m);
    return at_pixel(static_cast<int>(pixel.x), static_cast<int>(pixel.y));
  }
  Color at_pixel(int x, int y) const {
    const size_t i = 3 * (static_cast<size_t>(y) * static_cast<size_t>(canvas_.width()) +
                          static_cast<size_t>(x));
    return {rgb_[i] / 255.0, rgb_[i + 1] / 255.0, rgb_[i + 2] / 255.0};
  }
  const MapFrame& frame() const { return frame_; }

 private:
  static constexpr MapRectangle kGround{-0.5 * kBed_m, 0.5 * kBed_m, -0.5 * kBed_m, 0.5 * kBed_m};
  Canvas canvas_;
  std::vector<uint8_t> rgb_;
  MapFrame frame_;
};

double distance(Color a, Color b) {
  return std::max(
      {std::abs(a.red - b.red), std::abs(a.green - b.green), std::abs(a.blue - b.blue)});
}

/// 0: grey.
double saturation(Color c) {
  return std::max({c.red, c.green, c.blue}) - std::min({c.red, c.green, c.blue});
}

/// Two level steps, west and east, with a slope between them.
HeightField step(double west_m, double east_m) {
  return HeightField::from_function(151, 151, 0.01, false, [=](double x, double /*y*/) {
    return west_m + (east_m - west_m) * std::clamp((x + 0.2) / 0.4, 0.0, 1.0);
  });
}

constexpr double kRounding = 1.5 / 255.0;

TEST(HeightMapPicture, WithACommonRangeOneHeightHasOneColour) {
  const HeightField low = step(0.05, 0.013);
  const HeightField high = step(0.05, 0.211);
  PictureOptions options;
  const Shown own_low(draw_height_map(low, options));
  const Shown own_high(draw_height_map(high, options));
  EXPECT_GT(distance(own_low.at(-0.5, 0.0), own_high.at(-0.5, 0.0)), 0.2);

  options.heights = common_range(low, high);
  EXPECT_NEAR(options.heights->low_m, 0.013, 1e-6);
  EXPECT_NEAR(options.heights->high_m, 0.211, 1e-6);
  const Shown common_low(draw_height_map(low, options));
  const Shown common_high(draw_height_map(high, options));
  EXPECT_LT(distance(common_low.at(-0.5, 0.0), common_high.at(-0.5, 0.0)), kRounding);
  const auto color_of = [](double m) { return height_color((m - 0.013) / (0.211 - 0.013)); };
  EXPECT_LT(distance(common_low.at(-0.5, 0.0), color_of(0.05)), kRounding);
  EXPECT_LT(distance(common_low.at(0.5, 0.0), color_of(0.013)), kRounding);
  EXPECT_LT(distance(common_high.at(0.5, 0.0), color_of(0.211)), kRounding);
}

TEST(HeightMapImage, HasTheColoursOfThePictureAndItsNorthOnTop) {
  // Higher in the north, 0.5 m wide and 1 m high, level at both ends.
  const HeightField field = HeightField::from_function(
      51, 101, 0.01, false, [](double /*x*/, double y) { return y > 0.0 ? 0.04 : -0.02; });
  const HeightRange heights{-0.03, 0.05};
  HeightPainter painter;
  const MapImage image = height_map_image(field, heights, 200, painter);
  EXPECT_EQ(image.width, 100);
  EXPECT_EQ(image.height, 200);
  ASSERT_EQ(image.rgb.size(), 3U * 100U * 200U);
  EXPECT_NEAR(image.ground.y_max - image.ground.y_min, 1.0, 1e-9);
  const auto color_at = [&](std::size_t column, std::size_t row) {
    const std::size_t i = 3 * (row * 100 + column);
    return Color{image.rgb[i] / 255.0, image.rgb[i + 1] / 255.0, image.rgb[i + 2] / 255.0};
  };
  EXPECT_LT(distance(color_at(50, 20), height_color(0.07 / 0.08)), kRounding);
  EXPECT_LT(distance(color_at(50, 180), height_color(0.01 / 0.08)), kRounding);
  // The scale says which height has that colour, in mm.
  const ColorScale scale = height_color_scale(heights);
  EXPECT_DOUBLE_EQ(scale.low, -30.0);
  EXPECT_DOUBLE_EQ(scale.high, 50.0);
  EXPECT_LT(distance(scale.color(40.0), color_at(50, 20)), kRounding);
  EXPECT_THROW(height_map_image(field, heights, 0, painter), InputError);
}

TEST(HeightMapPicture, SaysHowFarItsContourLinesAreApart) {
  // 8 degrees over 1.5 m rise 211 mm: lines every 20 mm, 10 of them.
  const HeightField ramp = HeightField::ramp(kBed_m, 0.01, 8.0);
  const PictureOptions options;
  const std::string subtitle = height_map_subtitle(ramp, options);
  EXPECT_NE(subtitle.find("contours every 20 mm"), std::string::npos) << subtitle;

  const Shown shown(draw_height_map(ramp, options));
  const PixelBox& map = shown.frame().map();
  const int row = static_cast<int>(map.top + 0.5 * map.height);
  int lines = 0;
  bool on_line = false;
  const auto brightness = [&](int x) {
    const Color c = shown.at_pixel(x, row);
    return c.red + c.green + c.blue;
  };
  for (int x = static_cast<int>(map.left) + 4; x < static_cast<int>(map.left + map.width) - 4;
       ++x) {
    const bool dark = brightness(x) < 0.95 * std::max(brightness(x - 4), brightness(x + 4));
    lines += dark && !on_line ? 1 : 0;
    on_line = dark;
  }
  const auto height_at = [&](double pixel_x) {
    return shown.frame().x_at(pixel_x) * std::tan(8.0 * 3.14159265358979 / 180.0);
  };
  const double first = std::ceil(height_at(map.left + 4) / 0.02);
  const double last = std::floor(height_at(map.left + map.width - 4) / 0.02);
  EXPECT_EQ(lines, static_cast<int>(last - first) + 1);
}

TEST(HeightMapPicture, NamesNoIntervalWhereNoContourLineIs) {
  const HeightField flat = HeightField::flat(kBed_m, 0.1);
  PictureOptions options;
  EXPECT_EQ(height_map_subtitle(flat, options).find("contours"), std::string::npos);
  options.heights = HeightRange{-0.1, 0.1};
  EXPECT_EQ(height_map_subtitle(flat, options).find("contours"), std::string::npos);
}

TEST(HeightMapPicture, AnIntervalBelowAMillimetreHasItsDecimals) {
  const HeightField ramp = HeightField::ramp(kBed_m, 0.01, 0.1);  // rises 2.6 mm
  PictureOptions options;
  options.subtitle = "Mine";
  EXPECT_EQ(height_map_subtitle(ramp, options), "Mine,  contours every 0.2 mm");
}

// Of a path that is cut short its first point is no start.
TEST(HeightMapPicture, MarksTheStartOfPathsThatBeginThere) {
  PictureOptions options;
  options.robots = {{{{-0.5, 0.0, 0}, {0.5, 0.0, 0}}, {}}};
  options.state_names = {"walk"};
  const Shown from_start(draw_height_map(step(0.0, 0.0), options));
  options.paths_from_start = false;
  const Shown cut_short(draw_height_map(step(0.0, 0.0), options));
  EXPECT_GT(distance(from_start.at(-0.5, 0.0), from_start.at(0.0, 0.0)), 0.3) << "a mark";
  EXPECT_LT(distance(cut_short.at(-0.5, 0.0), cut_short.at(0.0, 0.0)), kRounding) << "path alone";
}

TEST(DifferencePicture, IsNeutralWhereNothingChanged) {
  const HeightField before = step(0.0, 0.0);
  HeightField after = before;
  const auto change_by = [&](int from_x, Height by) {
    for (int iy = 60; iy < 90; ++iy) {
      for (int ix = from_x; ix < from_x + 30; ++ix) after.set_node(ix, iy, after.node(ix, iy) + by);
    }
  };
  constexpr Height kCentimetre = 167772;
  change_by(20, -kCentimetre);
  change_by(100, kCentimetre / 2);
  const Shown shown(draw_difference(before, after, {}));
  EXPECT_LT(distance(shown.at(0.0, 0.0), difference_color(0.0)), kRounding);
  EXPECT_LT(saturation(shown.at(0.0, 0.0)), 0.02);
  EXPECT_LT(saturation(shown.at(-0.4, 0.5)), 0.02);
  EXPECT_LT(distance(shown.at(-0.4, 0.0), difference_color(-1.0)), kRounding);
  EXPECT_LT(distance(shown.at(0.4, 0.0), difference_color(0.5)), kRounding);
}

TEST(DifferencePicture, SlopesWithoutAChangeAreGrey) {
  const HeightField ramp = HeightField::ramp(kBed_m, 0.01, 15.0);
  HeightField after = ramp;
  after.set_node(5, 5, after.node(5, 5) + 500000);
  const Shown shown(draw_difference(ramp, after, {}));
  EXPECT_LT(saturation(shown.at(0.3, 0.3)), 0.02);
  EXPECT_GT(saturation(shown.at(ramp.node_x(5), ramp.node_y(5))), 0.2);
}

}  // namespace
}  // namespace screed
