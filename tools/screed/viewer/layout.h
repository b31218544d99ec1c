// Where everything lies in a window of any size, as rectangles: plain functions of the sizes and
// the words, so that a test can look for overlaps. And the colours that the parts share.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/color_map.h"
#include "tools/screed/viewer/ground_view.h"

namespace screed::viewer {

inline constexpr Color kBackground{0.085, 0.100, 0.118};
inline constexpr Color kBeyond{0.050, 0.060, 0.072};
inline constexpr Color kTrack{0.20, 0.23, 0.26};
inline constexpr Color kPaleInk{0.93, 0.945, 0.955};
inline constexpr Color kFaintInk{0.58, 0.62, 0.66};
inline constexpr Color kAccent{0.98, 0.66, 0.20};
inline constexpr Color kGood{0.38, 0.78, 0.47};
inline constexpr Color kAlarm{0.96, 0.36, 0.33};
inline constexpr Color kCasing{1.0, 1.0, 1.0};
inline constexpr Color kInk{0.10, 0.115, 0.13};
inline constexpr Color kHull{0.90, 0.91, 0.92};
inline constexpr Color kRubber{0.13, 0.14, 0.15};
inline constexpr Color kLug{0.33, 0.35, 0.37};

/// The smallest window that shows everything readably. Smaller ones are drawn in this size.
inline constexpr int kMinWindowWidth_px = 480;
inline constexpr int kMinWindowHeight_px = 360;
/// Of either side.
inline constexpr int kMaxWindowSide_px = 8000;

/// The width of words in a style, pixels.
using Measure = std::function<double(const std::string&, const TextStyle&)>;

/// Words on one line, with the rectangle that they fill.
struct TextItem {
  PixelBox box;
  std::string words;
  TextStyle style;

  Pixel anchor() const;  ///< for Canvas::text()
};

/// Words whose left end (with TextAlign::kRight: right end, kCenter: middle) is `x` and whose base
/// line is `y`.
TextItem text_item(Pixel at, const std::string& words, const TextStyle& style,
                   const Measure& measure);
/// The words, cut off with an ellipsis where they are wider than `width`.
std::string elided(const std::string& words, const TextStyle& style, double width,
                   const Measure& measure);
/// Lines no wider than `width`, broken at blanks; a word that is wider is elided.
std::vector<std::string> wrapped(const std::string& words, const TextStyle& style, double width,
                                 const Measure& measure);

/// The parts of the window. Together they fill it.
struct Layout {
  double scale = 1.0;  ///< of texts and margins: less in a small window
  PixelBox terrain{};
  PixelBox timeline{};
  PixelBox panel{};
};

/// width_px, height_px: at least kMinWindowWidth_px, kMinWindowHeight_px.
Layout layout_of(int width_px, int height_px);

/// What lies over the terrain.
struct OverlayLayout {
  struct Badge {
    PixelBox box;
    TextItem text;
  };
  std::vector<Badge> badges;
  PixelBox scale_bar{};
  double scale_bar_left = 0.0;   ///< of the bar itself
  double scale_bar_width = 0.0;  ///< likewise, pixels
  double scale_bar_base = 0.0;   ///< y
  TextItem scale_bar_text;
  PixelBox color_bar{};
  PixelBox color_ramp{};  ///< the colours themselves
  std::vector<TextItem> color_texts;
  std::vector<double> color_ticks;  ///< y
};

OverlayLayout overlay_layout(const Layout& layout, const std::vector<std::string>& badges,
                             double pixels_per_metre, const ShadingScale& colors,
                             const Measure& measure);

/// The numbers below the bar of the timeline.
std::vector<TextItem> timeline_texts(const Layout& layout, double duration_s,
                                     const Measure& measure);
/// The ends of that bar, pixels from the left, and its y.
struct TimelineBar {
  double left;
  double right;
  double y;
};
TimelineBar timeline_bar(const Layout& layout);

/// A line of the help: keys and what they do.
struct HelpLine {
  std::string keys;
  std::string what;
};

/// The keys, over the terrain where there is room for them, else instead of the whole window.
struct HelpLayout {
  PixelBox box{};
  std::vector<TextItem> texts;
};

HelpLayout help_layout(const Layout& layout, const std::vector<HelpLine>& lines,
                       const Measure& measure);

}  // namespace screed::viewer
