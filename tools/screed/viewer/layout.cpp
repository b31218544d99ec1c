// Sizes follow the window between two bounds; words follow the room that is left.
#include "tools/screed/viewer/layout.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host_sim/render/picture/map_frame.h"

namespace screed::viewer {
namespace {

// Of the window in which texts have their full size, and how small they get.
constexpr double kFullWidth_px = 960.0;
constexpr double kFullHeight_px = 720.0;
constexpr double kMinScale = 0.75;

constexpr double kPanelShare = 0.3;
constexpr double kMaxPanel_px = 300.0;
constexpr double kMinPanel_px = 192.0;
constexpr double kTimeline_px = 46.0;
constexpr double kTimelineMargin_px = 22.0;
constexpr double kEdge_px = 16.0;  // between the terrain's edge and what lies over it

/// From the base line to the top of letters and down to their tails, in sizes of the font.
constexpr double kAscent = 0.8;
constexpr double kDescent = 0.22;

const char* const kEllipsis = "\u2026";

/// The start of a character that begins at or before `at`, which UTF-8 may have in several bytes.
size_t character_start(const std::string& words, size_t at) {
  while (at > 0 && (static_cast<unsigned char>(words[at]) & 0xC0U) == 0x80U) --at;
  return at;
}

std::string length_text(double length_m) {
  if (length_m >= 1.0) return number_text(length_m, 0) + " m";
  if (length_m >= 0.01) return number_text(length_m * 100.0, 0) + " cm";
  return number_text(length_m * 1000.0, 0) + " mm";
}

void lay_out_badges(OverlayLayout& overlay, const Layout& layout,
                    const std::vector<std::string>& badges, const Measure& measure) {
  const double s = layout.scale;
  const TextStyle style{.size_px = 13.0 * s, .color = kPaleInk, .bold = true};
  const double edge = kEdge_px * s;
  const double pad = 12.0 * s;
  const double height = 28.0 * s;
  const double right = layout.terrain.width - edge;
  double left = edge;
  double top = edge;
  for (const std::string& badge : badges) {
    const std::string words = elided(badge, style, right - edge - 2.0 * pad, measure);
    const double width = measure(words, style) + 2.0 * pad;
    if (left + width > right && left > edge) {
      left = edge;
      top += height + 8.0 * s;
    }
    overlay.badges.push_back({{left, top, width, height},
                              text_item({left + pad, top + 19.0 * s}, words, style, measure)});
    left += width + 10.0 * s;
  }
}

void lay_out_color_bar(OverlayLayout& overlay, const Layout& layout, const ShadingScale& colors,
                       const Measure& measure) {
  const double s = layout.scale;
  const double pad = 12.0 * s;
  const double ramp_width = 14.0 * s;
  const double ramp_height = std::min(170.0 * s, 0.45 * layout.terrain.height);
  const double label_gap = 8.0 * s;
  const TextStyle name{.size_px = 13.0 * s, .color = kPaleInk};
  const TextStyle unit{.size_px = 11.0 * s, .color = kFaintInk};
  const TextStyle number{.size_px = 11.0 * s, .color = kPaleInk};
  const Ticks ticks = round_ticks(colors.low, colors.high, ramp_height > 120.0 ? 6 : 4);
  double widest = std::max(measure(colors.label, name), measure(colors.unit, unit));
  for (const double value : ticks.values) {
    widest = std::max(widest,
                      ramp_width + label_gap + measure(number_text(value, ticks.decimals), number));
  }
  const double width = widest + 2.0 * pad;
  const double head = 44.0 * s;
  const double height = head + ramp_height + 14.0 * s;
  overlay.color_bar = {layout.terrain.width - kEdge_px * s - width,
                       layout.terrain.height - kEdge_px * s - height, width, height};
  const double left = overlay.color_bar.left + pad;
  const double top = overlay.color_bar.top + head;
  overlay.color_ramp = {left, top, ramp_width, ramp_height};
  overlay.color_texts.push_back(
      text_item({left, overlay.color_bar.top + 18.0 * s}, colors.label, name, measure));
  overlay.color_texts.push_back(
      text_item({left, overlay.color_bar.top + 32.0 * s}, colors.unit, unit, measure));
  for (const double value : ticks.values) {
    const double y = top + ramp_height * (colors.high - value) / (colors.high - colors.low);
    overlay.color_ticks.push_back(y);
    overlay.color_texts.push_back(text_item({left + ramp_width + label_gap, y + 4.0 * s},
                                            number_text(value, ticks.decimals), number, measure));
  }
}

void lay_out_scale_bar(OverlayLayout& overlay, const Layout& layout, double pixels_per_metre,
                       const Measure& measure) {
  const double s = layout.scale;
  const double pad = 14.0 * s;
  const double edge = kEdge_px * s;
  const double room = overlay.color_bar.left - 2.0 * edge - 2.0 * pad;
  const double longest = std::min(180.0 * s, room);
  const double length_m = round_ticks(0.0, longest / pixels_per_metre, 3).values.back();
  overlay.scale_bar_width = length_m * pixels_per_metre;
  const TextStyle style{.size_px = 13.0 * s, .color = kPaleInk, .align = TextAlign::kCenter};
  const std::string words = length_text(length_m);
  const double width = std::max(overlay.scale_bar_width, measure(words, style)) + 2.0 * pad;
  const double height = 44.0 * s;
  const double top = layout.terrain.height - edge - height;
  overlay.scale_bar = {edge, top, width, height};
  overlay.scale_bar_left = edge + 0.5 * (width - overlay.scale_bar_width);
  overlay.scale_bar_base = top + height - 12.0 * s;
  overlay.scale_bar_text =
      text_item({edge + 0.5 * width, overlay.scale_bar_base - 11.0 * s}, words, style, measure);
}

}  // namespace

Pixel TextItem::anchor() const {
  const double x = style.align == TextAlign::kLeft     ? box.left
                   : style.align == TextAlign::kCenter ? box.left + 0.5 * box.width
                                                       : box.left + box.width;
  return {x, box.top + kAscent * style.size_px};
}

TextItem text_item(Pixel at, const std::string& words, const TextStyle& style,
                   const Measure& measure) {
  const double width = measure(words, style);
  const double before = style.align == TextAlign::kLeft     ? 0.0
                        : style.align == TextAlign::kCenter ? 0.5 * width
                                                            : width;
  return {
      {at.x - before, at.y - kAscent * style.size_px, width, (kAscent + kDescent) * style.size_px},
      words,
      style};
}

std::string elided(const std::string& words, const TextStyle& style, double width,
                   const Measure& measure) {
  if (measure(words, style) <= width) return words;
  size_t end = words.size();
  while (end > 0) {
    end = character_start(words, end - 1);
    std::string shorter = words.substr(0, end);
    while (!shorter.empty() && shorter.back() == ' ') shorter.pop_back();
    shorter += kEllipsis;
    if (measure(shorter, style) <= width) return shorter;
  }
  return kEllipsis;
}

std::vector<std::string> wrapped(const std::string& words, const TextStyle& style, double width,
                                 const Measure& measure) {
  std::vector<std::string> lines;
  std::string rest = words;
  while (!rest.empty()) {
    size_t end = rest.size();
    while (measure(rest.substr(0, end), style) > width) {
      const size_t blank = end == 0 ? std::string::npos : rest.rfind(' ', end - 1);
      if (blank == std::string::npos || blank == 0) {
        end = std::min(rest.find(' ', 1), rest.size());
        break;
      }
      end = blank;
    }
    lines.push_back(elided(rest.substr(0, end), style, width, measure));
    rest = end < rest.size() ? rest.substr(end + 1) : "";
  }
  return lines;
}

Layout layout_of(int width_px, int height_px) {
  const double width = width_px;
  const double height = height_px;
  Layout layout;
  layout.scale =
      std::clamp(std::min(width / kFullWidth_px, height / kFullHeight_px), kMinScale, 1.0);
  // Whole pixels: the terrain is painted pixel by pixel.
  const double panel = std::floor(std::clamp(kPanelShare * width, kMinPanel_px, kMaxPanel_px));
  const double timeline = std::floor(kTimeline_px * layout.scale);
  layout.terrain = {0.0, 0.0, width - panel, height - timeline};
  layout.timeline = {0.0, layout.terrain.height, layout.terrain.width, timeline};
  layout.panel = {layout.terrain.width, 0.0, panel, height};
  return layout;
}

OverlayLayout overlay_layout(const Layout& layout, const std::vector<std::string>& badges,
                             double pixels_per_metre, const ShadingScale& colors,
                             const Measure& measure) {
  OverlayLayout overlay;
  lay_out_badges(overlay, layout, badges, measure);
  lay_out_color_bar(overlay, layout, colors, measure);
  lay_out_scale_bar(overlay, layout, pixels_per_metre, measure);
  return overlay;
}

TimelineBar timeline_bar(const Layout& layout) {
  const double margin = kTimelineMargin_px * layout.scale;
  return {margin, layout.timeline.width - margin, layout.timeline.top + 16.0 * layout.scale};
}

std::vector<TextItem> timeline_texts(const Layout& layout, double duration_s,
                                     const Measure& measure) {
  const TimelineBar bar = timeline_bar(layout);
  const TextStyle style{
      .size_px = 11.0 * layout.scale, .color = kFaintInk, .align = TextAlign::kCenter};
  std::vector<TextItem> texts;
  for (int most = 9; most >= 2; --most) {
    texts.clear();
    const Ticks ticks = round_ticks(0.0, duration_s, most);
    bool fits = true;
    for (const double value : ticks.values) {
      const double x = bar.left + (bar.right - bar.left) * value / duration_s;
      TextItem text = text_item({x, layout.timeline.top + 37.0 * layout.scale},
                                number_text(value, ticks.decimals) + " s", style, measure);
      // The last one of a long run would stand out of the window.
      const double beyond = text.box.left + text.box.width - layout.timeline.width + 4.0;
      if (beyond > 0.0) text.box.left -= beyond;
      text.box.left = std::max(text.box.left, 4.0);
      constexpr double kGap_px = 12.0;
      fits = fits && (texts.empty() ||
                      texts.back().box.left + texts.back().box.width + kGap_px < text.box.left);
      texts.push_back(std::move(text));
    }
    if (fits) break;
  }
  return texts;
}

HelpLayout help_layout(const Layout& layout, const std::vector<HelpLine>& lines,
                       const Measure& measure) {
  constexpr double kMargin_px = 6.0;
  constexpr double kRow_px = 25.0;
  constexpr double kHead_px = 74.0;  // heading and margins
  constexpr double kPad_px = 28.0;
  constexpr double kGap_px = 22.0;
  const TextStyle keys_style{.size_px = 14.0, .color = kAccent, .bold = true};
  const TextStyle what_style{.size_px = 14.0, .color = kPaleInk};
  double keys_width = 0.0;
  double what_width = 0.0;
  for (const HelpLine& line : lines) {
    keys_width = std::max(keys_width, measure(line.keys, keys_style));
    what_width = std::max(what_width, measure(line.what, what_style));
  }
  const double full_width = keys_width + what_width + kGap_px + 2.0 * kPad_px;
  const double full_height = kRow_px * static_cast<double>(lines.size()) + kHead_px;
  // Rows move together before letters get smaller.
  constexpr double kTightRows = 0.72;
  const auto scale_in = [&](double width, double height) {
    return std::min({1.0, (width - 2.0 * kMargin_px) / full_width,
                     (height - 2.0 * kMargin_px) / full_height / kTightRows});
  };
  double width = layout.terrain.width;
  double height = layout.terrain.height;
  const bool terrain_has_room = scale_in(width, height) >= kMinScale;
  if (!terrain_has_room) {
    width += layout.panel.width;
    height = layout.panel.height;
  }
  const double s = scale_in(width, height);
  const double tight = std::min(s, (height - 2.0 * kMargin_px) / full_height);
  const double row = tight * kRow_px;
  const double head = tight * kHead_px;
  HelpLayout help;
  help.box.width = full_width * s;
  help.box.height = row * static_cast<double>(lines.size()) + head;
  help.box.left = 0.5 * (width - help.box.width);
  help.box.top = 0.5 * (height - help.box.height);
  const double left = help.box.left + kPad_px * s;
  double y = help.box.top + 0.5 * head;
  // Half of the panel beside it would be no help.
  if (!terrain_has_room) help.box = {0.0, 0.0, width, height};
  const auto add = [&](double x, const std::string& words, TextStyle style) {
    style.size_px *= s;
    help.texts.push_back(text_item({x, y}, words, style, measure));
  };
  add(left, "Keys", {.size_px = 18.0, .color = kPaleInk, .bold = true});
  y += 0.45 * head;
  for (const HelpLine& line : lines) {
    add(left, line.keys, keys_style);
    add(left + (keys_width + kGap_px) * s, line.what, what_style);
    y += row;
  }
  return help;
}

}  // namespace screed::viewer
