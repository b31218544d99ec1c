// The viewer's layout at many sizes of the window: nothing overlaps, nothing stands out of its
// part, what is left out is said.
#include "tools/screed/viewer/layout.h"

#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/run/simulation/outcome.h"
#include "tools/screed/viewer/input.h"
#include "tools/screed/viewer/panel.h"

namespace screed::viewer {
namespace {

struct Size {
  int width;
  int height;
};
const std::vector<Size> kSizes = {{480, 360},  {480, 900},   {520, 400},  {640, 420},
                                  {640, 480},  {800, 600},   {1000, 360}, {1024, 768},
                                  {1280, 800}, {1920, 1080}, {3840, 2160}};

class ViewerLayout : public ::testing::Test {
 protected:
  Canvas canvas_{10, 10, {}};
  Measure measure_ = [this](const std::string& words, const TextStyle& style) {
    return canvas_.text_width(words, style);
  };
};

bool inside(const PixelBox& part, const PixelBox& whole) {
  constexpr double kRounding = 1e-6;
  return part.left >= whole.left - kRounding && part.top >= whole.top - kRounding &&
         part.left + part.width <= whole.left + whole.width + kRounding &&
         part.top + part.height <= whole.top + whole.height + kRounding;
}

bool overlap(const PixelBox& a, const PixelBox& b) {
  return a.left < b.left + b.width && b.left < a.left + a.width && a.top < b.top + b.height &&
         b.top < a.top + a.height;
}

/// Every box lies in `whole`, and no two share a pixel.
void expect_apart(const std::vector<std::pair<std::string, PixelBox>>& boxes,
                  const PixelBox& whole) {
  for (size_t i = 0; i < boxes.size(); ++i) {
    EXPECT_TRUE(inside(boxes[i].second, whole)) << boxes[i].first;
    for (size_t j = 0; j < i; ++j) {
      EXPECT_FALSE(overlap(boxes[i].second, boxes[j].second))
          << boxes[i].first << " and " << boxes[j].first;
    }
  }
}

std::vector<std::pair<std::string, PixelBox>> boxes_of(const std::vector<TextItem>& texts) {
  std::vector<std::pair<std::string, PixelBox>> boxes;
  boxes.reserve(texts.size());
  for (const TextItem& text : texts) boxes.emplace_back(text.words, text.box);
  return boxes;
}

/// The words of the panel, and what is beside them.
bool says(const PanelLayout& panel, const std::string& part) {
  for (const TextItem& text : panel.texts) {
    if (text.words.find(part) != std::string::npos) return true;
  }
  return false;
}

/// As much as a panel ever has to say.
Status full_status() {
  Status status;
  status.title = "a_long_name_of_an_experiment_with_many_words";
  status.subtitle = "an external ground station drives on soft soil (dry_sand), seed 123456789";
  status.time_s = 3599.99;
  status.duration_s = 36000.0;
  status.pace = "\u00d7 0.25";
  status.state = static_cast<int>(RobotState::kRunning);
  status.leveling_state = static_cast<int>(message::LevelingState::kTrainingDrive);
  status.states_seen = (1U << kLevelingStates) - 1U;
  status.faults = 0x0102;
  status.motion = {-0.25, -6.2, -0.25, -6.2, -1.5, -1.5, -3.1, -10.0, -10.0, 0.1234, 12.55};
  status.terrain.before = {12.34, 56.7, 88.8, 0.999};
  status.terrain.now = status.terrain.before;
  status.terrain.flat_limit_deg = 5.0;
  status.terrain.loose = true;
  status.terrain.volume = Status::VolumeMoved{0.123456, 0.0001, 0.0001, 0.1234, 0.0567};
  status.leveling_before = Status::Leveling{0.1234, 0.0567, 0.999, 0.0};
  status.leveling_now = Status::Leveling{0.1234, 0.0567, 0.999, -0.999};
  status.notice =
      "Heights of the ticks were not recorded (sim --heights does): the terrain is that of the "
      "start, at the end that of the end.";
  status.driver = "EMERGENCY STOP: C clears it and drives on";
  status.keys = Controls(false, 1.0).key_hint();
  return status;
}

Status short_status() {
  Status status;
  status.title = "first_drive";
  status.subtitle = "hill_sensing drives on rigid ground, seed 1";
  status.pace = "paused";
  status.duration_s = 60.0;
  status.states_seen = 1;
  status.keys = "H  keys";
  return status;
}

TEST_F(ViewerLayout, ThePartsFillTheWindow) {
  for (const Size& size : kSizes) {
    SCOPED_TRACE(::testing::Message() << size.width << "x" << size.height);
    const Layout layout = layout_of(size.width, size.height);
    const PixelBox window{0.0, 0.0, static_cast<double>(size.width),
                          static_cast<double>(size.height)};
    expect_apart(
        {{"terrain", layout.terrain}, {"timeline", layout.timeline}, {"panel", layout.panel}},
        window);
    const auto area = [](const PixelBox& box) { return box.width * box.height; };
    EXPECT_NEAR(area(layout.terrain) + area(layout.timeline) + area(layout.panel), area(window),
                1e-6);
    EXPECT_GT(layout.terrain.width, 0.55 * size.width);
    EXPECT_GE(layout.scale * 14.0, 10.0) << "unreadable";
  }
}

TEST_F(ViewerLayout, NothingInThePanelOverlaps) {
  for (const Size& size : kSizes) {
    for (const Status& status : {full_status(), short_status()}) {
      SCOPED_TRACE(::testing::Message() << size.width << "x" << size.height);
      const Layout layout = layout_of(size.width, size.height);
      const PanelLayout panel = panel_layout(layout, status, measure_);
      std::vector<std::pair<std::string, PixelBox>> boxes = boxes_of(panel.texts);
      boxes.reserve(boxes.size() + panel.marks.size());
      for (const PanelLayout::Mark& mark : panel.marks) boxes.emplace_back("mark", mark.box);
      expect_apart(boxes, layout.panel);
    }
  }
}

TEST_F(ViewerLayout, WhatThePanelLeavesOutIsSaid) {
  for (const Size& size : kSizes) {
    for (const Status& status : {full_status(), short_status()}) {
      SCOPED_TRACE(::testing::Message() << size.width << "x" << size.height);
      const PanelLayout panel = panel_layout(layout_of(size.width, size.height), status, measure_);
      const bool whole = says(panel, "steepest") && says(panel, "heading") && says(panel, "ROBOT");
      EXPECT_NE(whole, says(panel, "more in a larger window"));
      // What a driver must see is there at any size.
      EXPECT_TRUE(says(panel, "H  keys"));
      EXPECT_TRUE(says(panel, status.pace));
      EXPECT_EQ(says(panel, "EMERGENCY STOP:"), status.faults != 0);
    }
  }
  const PanelLayout large = panel_layout(layout_of(1280, 900), short_status(), measure_);
  EXPECT_FALSE(says(large, "more in a larger window"));
  const PanelLayout small = panel_layout(layout_of(480, 360), full_status(), measure_);
  EXPECT_TRUE(says(small, "more in a larger window"));
}

TEST_F(ViewerLayout, OverlaysLieApartOnTheTerrain) {
  const std::vector<std::string> badges = {"paused", "follow", "\u25cf recording", "gamepad"};
  const std::vector<ShadingScale> scales = {{"height", "mm", -1234.0, 1234.0},
                                            {"change", "mm", -10000.0, 10000.0},
                                            {"slope", "degrees", 0.0, 30.0}};
  for (const Size& size : kSizes) {
    for (const ShadingScale& scale : scales) {
      for (double zoom = Camera::kMinScale; zoom < Camera::kMaxScale; zoom *= 1.7) {
        SCOPED_TRACE(::testing::Message()
                     << size.width << "x" << size.height << " " << scale.label << " " << zoom);
        const Layout layout = layout_of(size.width, size.height);
        const OverlayLayout overlay = overlay_layout(layout, badges, zoom, scale, measure_);
        std::vector<std::pair<std::string, PixelBox>> boxes = {{"scale bar", overlay.scale_bar},
                                                               {"colour bar", overlay.color_bar}};
        for (const OverlayLayout::Badge& badge : overlay.badges) {
          boxes.emplace_back(badge.text.words, badge.box);
          EXPECT_TRUE(inside(badge.text.box, badge.box)) << badge.text.words;
        }
        ASSERT_EQ(boxes.size(), 6U);
        expect_apart(boxes, layout.terrain);
        expect_apart({{"words", overlay.scale_bar_text.box}}, overlay.scale_bar);
        std::vector<std::pair<std::string, PixelBox>> colors = boxes_of(overlay.color_texts);
        colors.emplace_back("colours", overlay.color_ramp);
        expect_apart(colors, overlay.color_bar);
      }
    }
  }
}

TEST_F(ViewerLayout, TimesLieApartBelowTheTimeline) {
  for (const Size& size : kSizes) {
    for (const double duration_s : {0.4, 3.0, 60.0, 123456.0, 8e5, 1e6}) {
      SCOPED_TRACE(::testing::Message() << size.width << "x" << size.height << " " << duration_s);
      const Layout layout = layout_of(size.width, size.height);
      const std::vector<TextItem> texts = timeline_texts(layout, duration_s, measure_);
      EXPECT_GE(texts.size(), 2U);
      expect_apart(boxes_of(texts), layout.timeline);
      for (const TextItem& text : texts) EXPECT_GT(text.box.top, timeline_bar(layout).y + 2.5);
    }
  }
}

TEST_F(ViewerLayout, AllKeysFitTheWindow) {
  Controls gamepad(false, 1.0);
  InputEvent added;
  added.kind = InputEvent::Kind::kGamepadAdded;
  added.name = "pad";
  gamepad.gamepad_event(added);
  for (const Size& size : kSizes) {
    for (const auto& lines : {Controls(true, 1.0).help_lines(), Controls(false, 1.0).help_lines(),
                              gamepad.help_lines()}) {
      SCOPED_TRACE(::testing::Message()
                   << size.width << "x" << size.height << ", " << lines.size() << " lines");
      const HelpLayout help = help_layout(layout_of(size.width, size.height), lines, measure_);
      const PixelBox window{0.0, 0.0, static_cast<double>(size.width),
                            static_cast<double>(size.height)};
      expect_apart({{"help", help.box}}, window);
      EXPECT_EQ(help.texts.size(), 2 * lines.size() + 1);
      expect_apart(boxes_of(help.texts), help.box);
      for (const TextItem& text : help.texts) EXPECT_GE(text.style.size_px, 9.0) << text.words;
    }
  }
}

TEST_F(ViewerLayout, LongWordsAreCutOffWithASign) {
  const TextStyle style{.size_px = 14.0};
  const std::string words = "\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc\u00fc";
  EXPECT_EQ(elided(words, style, 1000.0, measure_), words);
  const std::string cut = elided(words, style, 40.0, measure_);
  EXPECT_LE(measure_(cut, style), 40.0);
  EXPECT_EQ(cut.substr(cut.size() - 3), "\u2026");
  EXPECT_EQ((cut.size() - 3) % 2, 0U) << "half a character";
  const std::vector<std::string> lines =
      wrapped("one two threeeeeeeeeeeeeee", style, 60.0, measure_);
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], "one two");
  EXPECT_EQ(lines[1].substr(lines[1].size() - 3), "\u2026");
}

}  // namespace
}  // namespace screed::viewer
