// The viewer without a window: camera, ground image, slope figures, keys, the drawn scene.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "firmware/leveling/leveling.h"
#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/run/simulation/recorders.h"
#include "tools/screed/viewer/drawing.h"
#include "tools/screed/viewer/input.h"
#include "tools/screed/viewer/viewer_display.h"

namespace screed::viewer {
namespace {

HeightField hills(bool wrap) {
  return HeightField::from_function(60, 50, 0.02, wrap, [](double x, double y) {
    return 0.04 * std::sin(7.0 * x) * std::cos(5.0 * y) + 0.01 * x;
  });
}

/// Presses ruts into the field and tells both that have to follow.
template <class Follower>
void dig(HeightField& field, Follower&& follower) {
  HeightWatch watch(field);
  for (int step = 0; step < 30; ++step) {
    for (int iy = 0; iy < 4; ++iy) {
      const int x = (step * 3) % field.nx();
      const int y = (step * 2 + iy) % field.ny();
      field.set_node(x, y, field.node(x, y) - (iy + 1) * 40000);
    }
    // Its edges and corners too.
    field.set_node(0, step, field.node(0, step) + 50000);
    field.set_node(field.nx() - 1, field.ny() - 1, step * 10000);
    follower(watch.changes(field));
  }
}

TEST(ViewerCamera, KeepsWhatLiesUnderTheMouse) {
  Camera camera;
  camera.set_box({0.0, 0.0, 900.0, 700.0});
  camera.fit({-1.5, 1.5, -1.0, 1.0});
  const Pixel corner = camera.to_pixel(-1.5, 1.0);
  EXPECT_GE(corner.x, 0.0);
  EXPECT_GE(corner.y, 0.0);
  EXPECT_NEAR(camera.x_at(corner.x), -1.5, 1e-12);
  EXPECT_NEAR(camera.y_at(corner.y), 1.0, 1e-12);

  const Pixel mouse{200.0, 550.0};
  const double x = camera.x_at(mouse.x);
  const double y = camera.y_at(mouse.y);
  const double scale = camera.scale();
  camera.zoom(3.0, mouse);
  EXPECT_NEAR(camera.scale(), 3.0 * scale, 1e-9);
  EXPECT_NEAR(camera.x_at(mouse.x), x, 1e-12);
  EXPECT_NEAR(camera.y_at(mouse.y), y, 1e-12);
  camera.drag(30.0, -20.0);
  EXPECT_NEAR(camera.x_at(mouse.x + 30.0), x, 1e-12);
  EXPECT_NEAR(camera.y_at(mouse.y - 20.0), y, 1e-12);
  camera.zoom(1e9, mouse);
  EXPECT_EQ(camera.scale(), Camera::kMaxScale);
  camera.zoom(1e-12, mouse);
  EXPECT_EQ(camera.scale(), Camera::kMinScale);
}

TEST(ViewerGroundImage, ChangedCellsAloneGiveTheWholePicture) {
  for (const bool wrap : {false, true}) {
    for (const Shading shading : {Shading::kHeight, Shading::kSlope, Shading::kChange}) {
      HeightField field = hills(wrap);
      TerrainImage image(field, field);
      TerrainImage fresh(field, field);
      EXPECT_EQ(image.paint(field, shading), 60U * 50U);
      size_t painted = 0;
      dig(field, [&](std::span<const HeightChange> changes) {
        image.update(field, changes);
        fresh.update(field, changes);
        painted += image.paint(field, shading);
      });
      EXPECT_GT(painted, 0U);
      if (shading != Shading::kChange) {  // whose scale grows with the changes
        EXPECT_LT(painted, 30U * 5U * 9U);
      }
      EXPECT_EQ(image.paint(field, shading), 0U);
      fresh.paint(field, shading);
      EXPECT_EQ(image.pixels(), fresh.pixels()) << wrap << static_cast<int>(shading);
    }
  }
}

TEST(ViewerSlopeLedger, AgreesWithTheStatisticsOfTheTerrain) {
  for (const bool wrap : {false, true}) {
    HeightField field = hills(wrap);
    SlopeStatistics ledger(field, 5.0);
    const auto expect_same = [&] {
      const TerrainStatistics expected = terrain_statistics(field);
      const SlopeFigures figures = ledger.figures();
      EXPECT_NEAR(figures.mean_deg, expected.mean_slope_deg, 0.005);
      EXPECT_NEAR(figures.p95_deg, expected.p95_slope_deg, 0.02);
      EXPECT_NEAR(figures.steepest_deg, expected.steepest_slope_deg, 0.02);
      EXPECT_DOUBLE_EQ(figures.flat, flatness(field, 5.0));
    };
    expect_same();
    dig(field, [&](std::span<const HeightChange> changes) { ledger.update(field, changes); });
    expect_same();
  }
  const HeightField ramp = HeightField::ramp(1.0, 0.01, 5.0);
  EXPECT_EQ(SlopeStatistics(ramp, 5.0).figures().flat, 1.0);
  EXPECT_EQ(SlopeStatistics(ramp, 4.98).figures().flat, 0.0);
  const HeightField level = HeightField::flat(1.0, 0.1);
  const SlopeFigures figures = SlopeStatistics(level, 0.0).figures();
  EXPECT_EQ(figures.mean_deg, 0.0);
  EXPECT_EQ(figures.steepest_deg, 0.0);
  EXPECT_EQ(figures.flat, 1.0);
}

TEST(ViewerInput, KeysOfAScript) {
  const ScriptedKey up = parse_scripted_key("Up@3-5.5");
  EXPECT_EQ(up.key, kKeyUp);
  EXPECT_EQ(up.from_s, 3.0);
  EXPECT_EQ(up.to_s, 5.5);
  EXPECT_EQ(parse_scripted_key("M@2").key, 'm');
  EXPECT_GT(parse_scripted_key("M@2").to_s, 2.0);
  EXPECT_EQ(parse_scripted_key("@@2").key, '@');
  for (const char* wrong : {"Up", "Up@", "@2", "Wide@2", "Up@x", "Up@5-3", "Up@-1", "Up@1-2-3"}) {
    EXPECT_THROW(parse_scripted_key(wrong), InputError) << wrong;
  }

  const std::vector<ScriptedKey> script = {up};
  EXPECT_TRUE(scripted_events(script, -1.0, 2.99).empty());
  ASSERT_EQ(scripted_events(script, 2.99, 3.0).size(), 1U);
  EXPECT_EQ(scripted_events(script, 2.99, 3.0)[0].kind, InputEvent::Kind::kKeyPressed);
  EXPECT_TRUE(scripted_events(script, 3.0, 5.49).empty());
  ASSERT_EQ(scripted_events(script, 3.0, 6.0).size(), 1U);
  EXPECT_EQ(scripted_events(script, 3.0, 6.0)[0].kind, InputEvent::Kind::kKeyReleased);
}

TEST(ViewerInput, ArrowKeysDriveARunAndScrubARecording) {
  Controls live(false, 1.0);
  EXPECT_FALSE(live.drives());
  live.key_down(kKeyUp, false);
  live.key_down(kKeyLeft, false);
  EXPECT_EQ(live.forward(), 1.0);
  EXPECT_EQ(live.left(), 1.0);
  EXPECT_FALSE(live.jump_s.has_value());
  live.key_up(kKeyUp);
  live.key_down(kKeyRight, true);
  EXPECT_EQ(live.forward(), 0.0);
  EXPECT_EQ(live.left(), 0.0);  // both ways
  live.key_up(kKeyLeft);
  EXPECT_LT(live.left(), 0.0);
  EXPECT_GT(live.left(), -1.0);  // slowly
  live.key_up(kKeyRight);
  EXPECT_FALSE(live.drives());

  Controls recorded(true, 1.0);
  recorded.key_down(kKeyRight, false);
  recorded.key_down(kKeyLeft, true);
  EXPECT_EQ(recorded.jump_s, -9.0);
  recorded.key_down(kKeyHome, false);
  EXPECT_EQ(recorded.to_share, 0.0);
}

TEST(ViewerInput, PaceGoesUpToAsFastAsItGoes) {
  Controls controls(false, 1.0);
  controls.key_down('+', false);
  EXPECT_EQ(controls.pace, 2.0);
  controls.key_down('-', false);
  controls.key_down('-', false);
  EXPECT_EQ(controls.pace, 0.5);
  for (int i = 0; i < 20; ++i) controls.key_down('+', false);
  EXPECT_EQ(controls.pace_text(), "max");
  controls.key_down('-', false);
  EXPECT_EQ(controls.pace, 64.0);
  for (int i = 0; i < 20; ++i) controls.key_down('-', false);
  EXPECT_EQ(controls.pace, 0.1);
}

TEST(ViewerInput, TheEmergencyStopIsTheMonitorsKeyAndIsListed) {
  Controls live(false, 1.0);
  live.key_down(kEmergencyStopKey, false);
  EXPECT_TRUE(live.emergency_stop);
  EXPECT_FALSE(live.paused);
  EXPECT_EQ(live.help_lines().front().keys, kEmergencyStopKeyName);
  EXPECT_NE(live.key_hint().find(std::string(kEmergencyStopKeyName) + "  emergency stop"),
            std::string::npos);
  live.key_down('p', false);
  EXPECT_TRUE(live.paused);
  // No robot listens in a recording.
  Controls recorded(true, 1.0);
  recorded.key_down(kEmergencyStopKey, false);
  EXPECT_FALSE(recorded.emergency_stop);
  EXPECT_TRUE(recorded.paused);
  EXPECT_EQ(recorded.key_hint().find("emergency"), std::string::npos);
}

TEST(ViewerInput, EscapeLeavesTheHelpFirst) {
  Controls controls(true, 1.0);
  controls.key_down('h', false);
  EXPECT_TRUE(controls.help);
  controls.key_down(kKeyEscape, false);
  EXPECT_FALSE(controls.help);
  EXPECT_FALSE(controls.closed);
  controls.key_down(kKeyEscape, false);
  EXPECT_TRUE(controls.closed);
}

TEST(ViewerSubtitle, SaysWhoDrives) {
  const auto said = [](const Driver& driver) { return subtitle_of(driver, "gravel", 7); };
  Driver driver;
  driver.algorithm = "hill_sensing";
  EXPECT_EQ(said(driver), "hill_sensing drives on gravel, seed 7");
  driver.external_link = true;
  EXPECT_EQ(said(driver), "hill_sensing (external ground station) drives on gravel, seed 7");
  driver.external_link = false;
  driver.replay = true;
  EXPECT_EQ(said(driver), "replay: hill_sensing drives on gravel, seed 7");
  driver.kind = Driver::Kind::kUnknownStation;
  EXPECT_EQ(said(driver), "replay: a ground station drives on gravel, seed 7");
  driver.replay = false;
  driver.kind = Driver::Kind::kKeyboard;
  EXPECT_EQ(said(driver), "the keyboard drives on gravel, seed 7");
  driver.kind = Driver::Kind::kGamepad;
  EXPECT_EQ(said(driver), "the gamepad drives on gravel, seed 7");
  driver.kind = Driver::Kind::kExternalStation;
  EXPECT_EQ(said(driver), "an external ground station drives on gravel, seed 7");
  EXPECT_EQ(terrain_name("scm", "dry_sand"), "soft soil (dry_sand)");
}

// ---- what is drawn ----

class ViewerDrawing : public ::testing::Test {
 protected:
  ViewerDrawing()
      : field_(HeightField::flat(2.0, 0.02)), image_(field_, field_), drawing_(900, 600) {
    image_.paint(field_, Shading::kHeight);
    shape_.hull = {-0.1, 0.1, -0.08, 0.08};
    shape_.running_gear = {{-0.12, 0.12, 0.08, 0.12}, {-0.12, 0.12, -0.12, -0.08}};
    shape_.left_gear = 1;
    scene_.ground = &image_;
    scene_.place = {field_.x_min(), field_.y_min(), field_.spacing_m(), field_.wrap()};
    scene_.bed = {field_.x_min(), field_.x_max(), field_.y_min(), field_.y_max()};
    scene_.camera.set_box(drawing_.terrain_box());
    scene_.camera.fit(scene_.bed);
    scene_.shape = &shape_;
    scene_.robots = robots_;
  }

  uint32_t at(double x_m, double y_m) {
    const Pixel pixel = scene_.camera.to_pixel(x_m, y_m);
    return drawing_.canvas()
        .pixels()[static_cast<size_t>(pixel.y) * static_cast<size_t>(drawing_.canvas().width()) +
                  static_cast<size_t>(pixel.x)];
  }
  static int brightness(uint32_t color) {
    return static_cast<int>((color >> 16U & 0xFFU) + (color >> 8U & 0xFFU) + (color & 0xFFU));
  }

  HeightField field_;
  TerrainImage image_;
  Drawing drawing_;
  RobotShape shape_;
  std::vector<ShownRobot> robots_{1};
  Scene scene_;
};

TEST_F(ViewerDrawing, TheRobotStandsWhereItIsAndLooksWhereItGoes) {
  drawing_.draw(scene_);
  const uint32_t ground = at(0.5, 0.5);
  robots_[0].robot.x_m = 0.5;
  robots_[0].robot.y_m = 0.5;
  robots_[0].robot.heading_rad = 1.5707963;  // north: its left track lies west of it
  drawing_.draw(scene_);
  EXPECT_NE(at(0.5, 0.5), ground);
  EXPECT_LT(brightness(at(0.4, 0.55)), 250);   // rubber
  EXPECT_LT(brightness(at(0.6, 0.455)), 250);  // between two lugs
  EXPECT_EQ(at(0.5, 0.65), ground);
  EXPECT_EQ(at(-0.5, 0.5), ground);
}

TEST_F(ViewerDrawing, ThePathShowsAsFarAsItHasCome) {
  for (int i = 0; i <= 20; ++i) {
    robots_[0].trail.push_back({static_cast<float>(-0.8 + 0.04 * i), -0.5F, 1});
  }
  robots_[0].robot.x_m = -0.4;
  robots_[0].robot.y_m = -0.5;
  robots_[0].robot.heading_rad = 0.0;
  scene_.trail_points = 10;
  drawing_.draw(scene_);
  const uint32_t ground = at(0.5, 0.5);
  EXPECT_EQ(at(-0.7, -0.5), pixel_of(state_color(1)));
  EXPECT_EQ(at(-0.05, -0.5), ground);
  scene_.show_trail = false;
  drawing_.draw(scene_);
  EXPECT_EQ(at(-0.7, -0.5), ground);
}

TEST_F(ViewerDrawing, TheRobotDoesNotHideThePathsEnd) {
  for (int i = 0; i <= 10; ++i)
    robots_[0].trail.push_back({static_cast<float>(-0.4 + 0.04 * i), 0.0F, 2});
  scene_.trail_points = robots_[0].trail.size();
  drawing_.draw(scene_);
  // Over the tail of the hull, which reaches from -0.1 to 0.1; its end at the robot's centre.
  EXPECT_EQ(at(-0.08, 0.0), pixel_of(state_color(2)));
  EXPECT_LT(brightness(at(0.0, 0.0)), 150);
  EXPECT_GT(brightness(at(0.0, 0.0) & 0xFFFFFFU), 0);
}

TEST_F(ViewerDrawing, WrappedGroundRepeatsDarker) {
  scene_.place.wrap = true;
  scene_.camera.zoom(0.5, scene_.camera.middle());
  drawing_.draw(scene_);
  EXPECT_LT(brightness(at(1.3, 0.5)), brightness(at(0.5, 0.5)));
  EXPECT_GT(brightness(at(1.3, 0.5)), brightness(at(0.5, 0.5)) / 3);
}

TEST_F(ViewerDrawing, WallsAreBoardsRoundTheBed) {
  scene_.camera.zoom(0.5, scene_.camera.middle());
  drawing_.draw(scene_);
  const uint32_t open = at(1.008, 0.5);
  const uint32_t inside = at(0.9, 0.5);
  scene_.place.walls = true;
  drawing_.draw(scene_);
  EXPECT_NE(at(1.008, 0.5), open);
  EXPECT_NEAR(brightness(at(1.008, 0.5)), brightness(pixel_of(kBoards)), 3);
  EXPECT_EQ(at(0.9, 0.5), inside);
}

TEST_F(ViewerDrawing, SameSceneSamePixelsAtAnySize) {
  drawing_.draw(scene_);
  const std::vector<uint8_t> first = drawing_.canvas().rgb();
  drawing_.draw(scene_);
  EXPECT_EQ(drawing_.canvas().rgb(), first);
  // What was written for another status is gone.
  scene_.status.notice = "Something else";
  drawing_.draw(scene_);
  EXPECT_NE(drawing_.canvas().rgb(), first);
  scene_.status.notice = "";
  drawing_.draw(scene_);
  EXPECT_EQ(drawing_.canvas().rgb(), first);
  drawing_.resize(10, 10);
  EXPECT_EQ(drawing_.canvas().width(), kMinWindowWidth_px);
  scene_.camera.set_box(drawing_.terrain_box());
  const std::vector<HelpLine> help = Controls(false, 1.0).help_lines();
  scene_.help = &help;
  drawing_.draw(scene_);
  EXPECT_EQ(drawing_.share_at(-5.0), 0.0);
  EXPECT_EQ(drawing_.share_at(1e4), 1.0);
}

TEST_F(ViewerDrawing, ScaleBarIsNeverEmpty) {
  for (double scale = Camera::kMinScale; scale < Camera::kMaxScale; scale *= 1.13) {
    scene_.camera.zoom(scale / scene_.camera.scale(), scene_.camera.middle());
    drawing_.draw(scene_);
    // Where the bar's middle is to be, there is ink, and the bar is long enough to compare with.
    const OverlayLayout overlay = overlay_layout(
        layout_of(900, 600), {}, scene_.camera.scale(), image_.scale(Shading::kHeight),
        [&](const std::string& words, const TextStyle& style) {
          return drawing_.canvas().text_width(words, style);
        });
    EXPECT_GT(overlay.scale_bar_width, 40.0) << scale;
    const std::span<uint32_t> pixels = drawing_.canvas().pixels();
    const auto x = static_cast<size_t>(overlay.scale_bar_left + 0.5 * overlay.scale_bar_width);
    const auto y = static_cast<size_t>(overlay.scale_bar_base);
    const auto width = static_cast<size_t>(drawing_.canvas().width());
    EXPECT_GT(brightness(pixels[y * width + x]), 500) << scale;
  }
}

}  // namespace
}  // namespace screed::viewer
