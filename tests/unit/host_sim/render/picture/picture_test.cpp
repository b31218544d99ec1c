// Pictures: ticks, colours, placement of map, path and robot, determinism, refused input.
#include <gtest/gtest.h>
#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/render/picture/path_overlay.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/simulation/outcome.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

class PictureTest : public ::testing::Test {
 protected:
  TempFolder temporary_;
  fs::path folder_ = temporary_.path();
};

RobotShape tracked_robot() {
  RobotShape shape;
  shape.hull = {-0.11, 0.11, -0.09, 0.09};
  shape.running_gear = {{-0.12, 0.12, 0.08, 0.11}, {-0.12, 0.12, -0.11, -0.08}};
  shape.left_gear = 1;
  return shape;
}

void write_picture(const fs::path& path, const HeightField& field, const PictureOptions& options) {
  HeightPainter painter;
  write_height_map_picture(path, field, options, painter);
}

PictureOptions small_picture() {
  PictureOptions options;
  options.width_px = 800;
  options.height_px = 700;
  options.title = "Test";
  options.state_names = {"drive", "turn"};
  options.robots = {{{{-0.5, -0.5, 0}, {0.0, 0.0, 1}, {0.5, 0.2, 1}},
                     RobotOutline{0.5, 0.2, 0.3, tracked_robot()}}};
  return options;
}

TEST(TicksTest, AreRoundAndFew) {
  const Ticks metres = round_ticks(-1.5, 1.5, 7);
  EXPECT_EQ(metres.values, (std::vector<double>{-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5}));
  EXPECT_EQ(metres.decimals, 1);
  EXPECT_EQ(round_ticks(0.0, 31.2, 9).values, (std::vector<double>{0, 5, 10, 15, 20, 25, 30}));
  const Ticks thousands = round_ticks(0.0, 4000.0, 5);
  EXPECT_EQ(thousands.step, 1000.0);
  EXPECT_EQ(thousands.decimals, 0);
  EXPECT_TRUE(round_ticks(1.0, 1.0, 5).values.empty());
  double high = 1e-6;
  for (int i = 0; i < 90; ++i) {
    high *= 1.37;
    for (int most = 2; most < 12; ++most) {
      const size_t count = round_ticks(0.0, high, most).values.size();
      ASSERT_LE(count, static_cast<size_t>(most));
      ASSERT_GE(2.5 * static_cast<double>(count), most - 1.0) << high;
    }
  }
}

TEST(TicksTest, NumbersHaveARealMinusAndNoNegativeZero) {
  EXPECT_EQ(number_text(-1.5, 1), "\u22121.5");
  EXPECT_EQ(number_text(-0.0001, 2), "0.00");
  EXPECT_EQ(number_text(12.0, 0), "12");
}

/// Relative luminance of an sRGB colour (IEC 61966-2-1).
double luminance(Color color) {
  const auto linear = [](double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
  };
  return 0.2126 * linear(color.red) + 0.7152 * linear(color.green) + 0.0722 * linear(color.blue);
}

/// CIE 1976 lightness, 0..100: what equal steps of brightness look like.
double lightness(Color color) {
  return 116.0 * std::cbrt(luminance(color)) - 16.0;
}

TEST(ColorMapTest, HeightsGetEvenlyLighter) {
  const double whole = lightness(height_color(1.0)) - lightness(height_color(0.0));
  EXPECT_GT(whole, 50.0);
  constexpr int kSteps = 20;
  for (int i = 0; i < kSteps; ++i) {
    const double step = lightness(height_color((i + 1.0) / kSteps)) -
                        lightness(height_color(static_cast<double>(i) / kSteps));
    EXPECT_NEAR(step, whole / kSteps, 0.35 * whole / kSteps) << i;
  }
  EXPECT_EQ(height_color(-3.0).red, height_color(0.0).red);
}

TEST(ColorMapTest, DifferencesAreBlueBelowAndRedAbove) {
  EXPECT_GT(difference_color(-1.0).blue, difference_color(-1.0).red + 0.3);
  EXPECT_GT(difference_color(1.0).red, difference_color(1.0).blue + 0.3);
  EXPECT_GT(lightness(difference_color(0.0)), 95.0);
  for (const double t : {0.25, 0.5, 0.75, 1.0}) {
    EXPECT_NEAR(lightness(difference_color(t)), lightness(difference_color(-t)), 7.0) << t;
  }
}

Color pixel(const Canvas& canvas, Pixel at) {
  const std::vector<uint8_t> rgb = canvas.rgb();
  const size_t i = 3 * (static_cast<size_t>(at.y) * static_cast<size_t>(canvas.width()) +
                        static_cast<size_t>(at.x));
  return {rgb[i] / 255.0, rgb[i + 1] / 255.0, rgb[i + 2] / 255.0};
}

TEST(CanvasTest, DrawsWhereItIsTold) {
  Canvas canvas(60, 40, {1.0, 1.0, 1.0});
  canvas.rectangle({10.0, 5.0, 20.0, 10.0}, {1.0, 0.0, 0.0});
  canvas.circle({45.0, 30.0}, 5.0, {0.0, 0.0, 1.0});
  canvas.set_row(0, 39, std::vector<uint32_t>(3, pixel_of({0.0, 1.0, 0.0})));
  EXPECT_EQ(pixel(canvas, {10, 5}).green, 0.0);
  EXPECT_EQ(pixel(canvas, {9, 5}).green, 1.0);
  EXPECT_EQ(pixel(canvas, {29, 14}).green, 0.0);
  EXPECT_EQ(pixel(canvas, {30, 15}).green, 1.0);
  EXPECT_EQ(pixel(canvas, {45, 30}).red, 0.0);
  EXPECT_EQ(pixel(canvas, {45, 36}).red, 1.0);
  EXPECT_EQ(pixel(canvas, {2, 39}).red, 0.0);
  EXPECT_EQ(pixel(canvas, {3, 39}).red, 1.0);
}

TEST(CanvasTest, WritesTextAndMeasuresIt) {
  Canvas canvas(200, 40, {1.0, 1.0, 1.0});
  canvas.text({5.0, 30.0}, "Screed 25\u00b0", {.size_px = 24.0});
  const std::vector<uint8_t> rgb = canvas.rgb();
  EXPECT_GT(std::count_if(rgb.begin(), rgb.end(), [](uint8_t v) { return v < 128; }), 300);
  const TextStyle small{.size_px = 10.0};
  const TextStyle large{.size_px = 20.0};
  EXPECT_NEAR(canvas.text_width("wide", large), 2.0 * canvas.text_width("wide", small), 0.1);
}

TEST(CanvasTest, ClipCutsOff) {
  Canvas canvas(20, 20, {1.0, 1.0, 1.0});
  canvas.clip({0.0, 0.0, 10.0, 20.0});
  canvas.rectangle({0.0, 0.0, 20.0, 20.0}, {0.0, 0.0, 0.0});
  EXPECT_EQ(pixel(canvas, {9, 9}).red, 0.0);
  EXPECT_EQ(pixel(canvas, {10, 9}).red, 1.0);
  canvas.unclip();
  canvas.rectangle({0.0, 0.0, 20.0, 20.0}, {0.0, 0.0, 0.0});
  EXPECT_EQ(pixel(canvas, {10, 9}).red, 0.0);
}

TEST(MapFrameTest, IsTrueToScaleWithNorthUp) {
  Canvas canvas(1200, 1000, {1.0, 1.0, 1.0});
  const MapFrame frame(canvas, {-1.5, 1.5, -1.0, 1.0}, 0.0);
  const Pixel center = frame.to_pixel(0.0, 0.0);
  EXPECT_NEAR(frame.to_pixel(0.5, 0.0).x - center.x, 0.5 * frame.pixels_per_metre(), 1e-9);
  EXPECT_NEAR(center.y - frame.to_pixel(0.0, 0.5).y, 0.5 * frame.pixels_per_metre(), 1e-9);
  EXPECT_NEAR(frame.to_pixel(-1.5, 1.0).y, frame.map().top, 1e-9);
  EXPECT_NEAR(frame.x_at(frame.to_pixel(0.7, 0.2).x), 0.7, 1e-12);
  EXPECT_NEAR(frame.y_at(frame.to_pixel(0.7, 0.2).y), 0.2, 1e-12);
}

TEST_F(PictureTest, SameInputGivesTheSameBytes) {
  const HeightField field = HeightField::ramp(1.5, 0.02, 10.0);
  write_picture(folder_ / "a.png", field, small_picture());
  write_picture(folder_ / "b.png", field, small_picture());
  EXPECT_GT(read_text(folder_ / "a.png").size(), 5000U);
  EXPECT_EQ(read_text(folder_ / "a.png"), read_text(folder_ / "b.png"));
}

TEST_F(PictureTest, EveryPartChangesThePicture) {
  const HeightField field = HeightField::ramp(1.5, 0.02, 10.0);
  const auto drawn = [&](const PictureOptions& options) {
    write_picture(folder_ / "picture.png", field, options);
    return read_text(folder_ / "picture.png");
  };
  const std::string whole = drawn(small_picture());
  PictureOptions options = small_picture();
  options.robots[0].outline->heading_rad += 0.5;
  EXPECT_NE(drawn(options), whole);
  options = small_picture();
  options.robots[0].path[1].state = 0;
  EXPECT_NE(drawn(options), whole);
  options = small_picture();
  options.state_names[1] = "stop";
  EXPECT_NE(drawn(options), whole);
  options = small_picture();
  options.title = "Other";
  EXPECT_NE(drawn(options), whole);
  options = small_picture();
  options.heights = HeightRange{-0.2, 0.2};
  EXPECT_NE(drawn(options), whole);
}

TEST_F(PictureTest, DrawsLevelGround) {
  EXPECT_NO_THROW(
      write_picture(folder_ / "flat.png", HeightField::flat(1.5, 0.1), small_picture()));
}

TEST(PathOverlayTest, AJumpOverTheSeamIsDrawnOnlyWithoutWrap) {
  PictureOptions options = small_picture();
  options.robots[0].outline.reset();
  // State 1 has a colour without blue.
  options.robots[0].path = {{-0.9, 0.0, 1}, {-0.8, 0.0, 1}, {0.8, 0.0, 1}, {0.9, 0.0, 1}};
  for (const bool wrap : {false, true}) {
    Canvas canvas(800, 700, {1.0, 1.0, 1.0});
    const MapFrame frame(canvas, {-1.0, 1.0, -1.0, 1.0}, 0.0);
    draw_path_overlay(canvas, frame, wrap, options);
    EXPECT_EQ(pixel(canvas, frame.to_pixel(0.0, 0.0)).blue < 0.5, !wrap);
    EXPECT_LT(pixel(canvas, frame.to_pixel(-0.82, 0.0)).blue, 0.5);
  }
}

// Between the wheels of a side is ground, between the axles of a track is the track.
TEST(PathOverlayTest, AWheeledRobotHasWheelsAndATrackedOneTracks) {
  Assembly model;
  for (const std::size_t side : {0U, 1U}) {
    const double y = side == 0 ? 0.3 : -0.3;
    model.wheels[side][0] = {0, {0.25, y, 0.0}, 0.1, 0.08, ""};
    model.wheels[side][1] = {0, {-0.25, y, 0.0}, 0.1, 0.08, ""};
  }
  for (const bool tracks : {false, true}) {
    PictureOptions options;
    options.robots = {
        {{}, RobotOutline{0.1, 0.2, std::numbers::pi / 2.0, shape_of(model, tracks)}}};
    Canvas canvas(800, 700, {0.0, 1.0, 0.0});
    const MapFrame frame(canvas, {-1.0, 1.0, -1.0, 1.0}, 0.0);
    draw_path_overlay(canvas, frame, false, options);
    // The robot looks north: its left is west.
    for (const double west : {-0.3, 0.3}) {
      for (const double north : {-0.25, 0.25}) {
        EXPECT_LT(pixel(canvas, frame.to_pixel(0.1 + west, 0.2 + north)).green, 0.3);
      }
      const Color between = pixel(canvas, frame.to_pixel(0.1 + west, 0.2));
      EXPECT_EQ(between.green < 0.3, tracks);
      EXPECT_EQ(between.red < 0.01 && between.green > 0.99, !tracks) << "the ground";
    }
    EXPECT_LT(pixel(canvas, frame.to_pixel(0.1 + 0.3, 0.2 + 0.34)).green, 0.3) << "radius";
    EXPECT_GT(pixel(canvas, frame.to_pixel(0.1 + 0.3, 0.2 + 0.37)).green, 0.9);
  }
}

TEST(PathOverlayTest, ThePathsEndLiesOverTheRobot) {
  PictureOptions options = small_picture();
  options.robots = {
      {{{-0.5, 0.0, 2}, {0.2, 0.0, 2}}, RobotOutline{0.2, 0.0, 0.0, tracked_robot()}}};
  Canvas canvas(800, 700, {1.0, 1.0, 1.0});
  const MapFrame frame(canvas, {-1.0, 1.0, -1.0, 1.0}, 0.0);
  draw_path_overlay(canvas, frame, false, options);
  const Color path = pixel(canvas, frame.to_pixel(0.12, 0.0));  // over the hull
  EXPECT_NEAR(path.red, state_color(2).red, 0.01);
  EXPECT_NEAR(path.blue, state_color(2).blue, 0.01);
  const Color end = pixel(canvas, frame.to_pixel(0.2, 0.0));
  EXPECT_LT(end.red + end.green + end.blue, 0.6);  // its dark mark
}

TEST(PathOverlayTest, TheLegendNamesTheStatesOfThePathInTheirColours) {
  PictureOptions options = small_picture();
  options.state_names = {"idle", "walk", "climb", "spin", "return", "drive"};
  options.robots[0].path = {{0.0, 0.0, 5}, {0.1, 0.0, 1}, {0.2, 0.0, 5}};
  EXPECT_EQ(states_on_paths(options), (std::vector<size_t>{1, 5}));
  Canvas canvas(800, 700, {1.0, 1.0, 1.0});
  const MapFrame frame(canvas, {-1.0, 1.0, -1.0, 1.0}, legend_height_px(options));
  draw_legend(canvas, frame, options);
  const auto has = [&](Color color) {
    const std::vector<uint8_t> rgb = canvas.rgb();
    const auto near = [](uint8_t byte, double part) {
      return std::abs(byte / 255.0 - part) < 0.01;
    };
    for (size_t i = 0; i < rgb.size(); i += 3) {
      if (near(rgb[i], color.red) && near(rgb[i + 1], color.green) && near(rgb[i + 2], color.blue))
        return true;
    }
    return false;
  };
  for (size_t state = 0; state < options.state_names.size(); ++state) {
    EXPECT_EQ(has(state_color(state)), state == 1 || state == 5) << state;
  }
}

TEST(StateColorTest, EveryStateOfTheSchemaHasAColourOfItsOwn) {
  ASSERT_EQ(kStateColors, kLevelingStates);
  for (size_t state = 0; state < kStateColors; ++state) {
    for (size_t other = 0; other < state; ++other) {
      const Color a = state_color(state);
      const Color b = state_color(other);
      EXPECT_GT(std::hypot(a.red - b.red, a.green - b.green, a.blue - b.blue), 0.15)
          << state << " and " << other;
    }
  }
}

TEST_F(PictureTest, DifferenceNeedsTheSameGrid) {
  const HeightField before = HeightField::ramp(1.5, 0.02, 10.0);
  HeightField after = before;
  write_difference_picture(folder_ / "same.png", before, after, small_picture());
  after.set_node(30, 30, after.node(30, 30) + (1 << 20));
  write_difference_picture(folder_ / "changed.png", before, after, small_picture());
  EXPECT_NE(read_text(folder_ / "same.png"), read_text(folder_ / "changed.png"));
  const HeightField grid(20, 20, 0.1, false);
  for (const HeightField& other :
       {HeightField(21, 20, 0.1, false), HeightField(20, 21, 0.1, false),
        HeightField(20, 20, 0.2, false), HeightField(20, 20, 0.1, true)}) {
    EXPECT_THROW(write_difference_picture(folder_ / "other.png", grid, other, small_picture()),
                 InputError);
  }
  EXPECT_FALSE(fs::exists(folder_ / "other.png"));
}

TEST_F(PictureTest, RefusesWrongOptions) {
  const HeightField field = HeightField::flat(1.5, 0.1);
  const auto refused = [&](const PictureOptions& options) {
    EXPECT_THROW(write_picture(folder_ / "no.png", field, options), InputError);
    EXPECT_FALSE(fs::exists(folder_ / "no.png"));
  };
  PictureOptions options = small_picture();
  options.robots[0].path[1].state = 2;
  refused(options);
  options = small_picture();
  options.robots[0].path[1].x_m = std::nan("");
  refused(options);
  options = small_picture();
  options.robots[0].outline->heading_rad = std::nan("");
  refused(options);
  options = small_picture();
  options.heights = HeightRange{0.2, 0.1};
  refused(options);
  options.heights = HeightRange{0.0, std::nan("")};
  refused(options);
  options = small_picture();
  options.width_px = 799;
  refused(options);
  options = small_picture();
  options.height_px = 8001;
  refused(options);
  options = small_picture();
  options.state_names.assign(kStateColors + 1, "state");
  refused(options);
}

TEST_F(PictureTest, SaysWhatCannotBeWritten) {
  std::ofstream(folder_ / "file") << "x";
  EXPECT_THROW(
      write_picture(folder_ / "file" / "a.png", HeightField::flat(1.5, 0.1), small_picture()),
      RunError);
}

}  // namespace
}  // namespace screed
