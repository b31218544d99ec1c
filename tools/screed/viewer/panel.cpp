// Rows of figures: what they say, then which of them there is room for.
#include "tools/screed/viewer/panel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

#include "host_sim/core/constants.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/run/simulation/outcome.h"
#include "tools/screed/viewer/layout.h"

namespace screed::viewer {
namespace {

constexpr double kMargin_px = 22.0;
constexpr double kText_px = 14.0;
constexpr double kMinText_px = 8.5;
const char* const kMore = "\u2026 more in a larger window";

Color robot_state_color(int state) {
  switch (static_cast<RobotState>(state)) {
    case RobotState::kRunning:
      return kGood;
    case RobotState::kFault:
      return kAlarm;
    case RobotState::kStopped:
    case RobotState::kArmed:
      return kAccent;
    case RobotState::kDisarmed:
      break;
  }
  return kFaintInk;
}

/// Minutes, seconds and hundredths.
std::string clock_text(double time_s) {
  const auto hundredths = static_cast<long>(std::lround(time_s * 100.0));
  char text[32];
  std::snprintf(text, sizeof text, "%ld:%02ld.%02ld", hundredths / 6000, hundredths / 100 % 60,
                hundredths % 100);
  return text;
}

std::string degrees(double value, int decimals = 1) {
  return number_text(value, decimals) + "\u00b0";
}

std::string volume_text(double m3) {
  constexpr double kLitre = 1e3;
  constexpr double kMillilitre = 1e6;
  const bool large = std::abs(m3) * kLitre >= 1.0;
  return large ? number_text(m3 * kLitre, 2) + " L" : number_text(m3 * kMillilitre, 0) + " mL";
}

/// When the panel is full, rows with larger numbers are left out first.
enum Importance : int { kAlways, kWho, kMotion, kChangeOrPath, kAttitude, kDetail, kSpare };

/// A row of the panel: words on the left, in the middle and on the right, each with its style.
struct Row {
  struct Words {
    std::string text;
    TextStyle style{};
  };
  int importance = kAlways;
  double height_px = 22.0;  ///< to the next base line
  Words left;
  Words middle;
  Words right;
  std::optional<Color> dot;
  std::optional<Color> swatch;
  bool heading = false;  ///< under a rule
};

/// Makes rows of a status.
class Rows {
 public:
  Rows(double width_px, double scale, const Measure& measure)
      : width_(width_px), scale_(scale), measure_(measure) {}

  Row& add(int importance, double height_px, const std::string& text, const TextStyle& style) {
    Row row;
    row.importance = importance;
    row.height_px = height_px;
    row.left = {text, style};
    rows.push_back(std::move(row));
    return rows.back();
  }
  void heading(int importance, const std::string& words, const std::string& middle = "",
               const std::string& right = "") {
    const TextStyle style{.size_px = 12.0, .color = kFaintInk, .bold = true};
    const TextStyle column{.size_px = 12.0, .color = kFaintInk, .align = TextAlign::kRight};
    Row& row = add(importance, 40.0, words, style);
    row.heading = true;
    row.middle = {middle, column};
    row.right = {right, column};
  }
  void figure(int importance, const std::string& name, const std::string& value,
              const std::string& before = "") {
    Row& row = add(importance, 22.0, name, {.size_px = kText_px, .color = kFaintInk});
    row.middle = {before, {.size_px = kText_px, .color = kFaintInk, .align = TextAlign::kRight}};
    row.right = {value, {.size_px = kText_px, .color = kPaleInk, .align = TextAlign::kRight}};
  }
  /// As many rows as the words need.
  void paragraph(int importance, const std::string& words, TextStyle style) {
    TextStyle drawn = style;
    drawn.size_px *= scale_;
    for (const std::string& line : wrapped(words, drawn, width_, measure_)) {
      add(importance, style.size_px + 5.0, line, style);
    }
  }

  std::vector<Row> rows;

 private:
  double width_;
  double scale_;
  const Measure& measure_;
};

void add_head(Rows& rows, const Status& s) {
  rows.add(kWho, 30.0, s.title, {.size_px = 19.0, .color = kPaleInk, .bold = true});
  rows.add(kWho, 3.0, "", {});
  rows.paragraph(kWho, s.subtitle, {.size_px = 12.5, .color = kFaintInk});
  Row& clock = rows.add(kAlways, 40.0, clock_text(s.time_s),
                        {.size_px = 32.0, .color = kPaleInk, .bold = true});
  clock.right = {s.pace,
                 {.size_px = 16.0, .color = kAccent, .align = TextAlign::kRight, .bold = true}};
  rows.add(kSpare, 23.0, "of " + clock_text(s.duration_s), {.size_px = 12.5, .color = kFaintInk});
  const auto state = static_cast<RobotState>(s.state);
  std::string words = state_name(state);
  if (state == RobotState::kRunning) {
    words += std::string(": ") +
             leveling_state_name(static_cast<message::LevelingState>(s.leveling_state));
  }
  rows.add(kAlways, 30.0, words, {.size_px = 16.0, .color = kPaleInk, .bold = true}).dot =
      robot_state_color(s.state);
  if (s.faults != 0) {
    rows.paragraph(kAlways, "faults: " + fault_names(static_cast<uint16_t>(s.faults)),
                   {.size_px = kText_px, .color = kAlarm, .bold = true});
  } else {
    rows.add(kDetail, 22.0, "no faults", {.size_px = kText_px, .color = kFaintInk});
  }
  if (!s.driver.empty()) {
    rows.paragraph(kAlways, s.driver, {.size_px = kText_px, .color = kAccent, .bold = true});
  }
}

void add_robot(Rows& rows, const Status::Motion& s) {
  rows.heading(kMotion, "ROBOT");
  const auto speed = [](double value) { return number_text(value * 1e3, 0) + " mm/s"; };
  rows.figure(kMotion, "speed", speed(s.speed_m_per_s));
  rows.figure(kAttitude, "turning", degrees(s.turn_rad_per_s * kDegPerRad, 0) + "/s");
  rows.figure(kMotion, "wanted",
              speed(s.wanted_m_per_s) + ",  " + degrees(s.wanted_rad_per_s * kDegPerRad, 0) + "/s");
  rows.figure(kAttitude, "pitch, roll",
              degrees(s.pitch_rad * kDegPerRad) + ",  " + degrees(s.roll_rad * kDegPerRad));
  rows.figure(kAttitude, "heading", degrees(s.heading_rad * kDegPerRad, 0));
  rows.figure(
      kDetail, "slip left, right",
      number_text(s.slip_left * 100.0, 0) + " %,  " + number_text(s.slip_right * 100.0, 0) + " %");
  if (s.sinkage_m) rows.figure(kAttitude, "sinkage", number_text(*s.sinkage_m * 1e3, 1) + " mm");
  rows.figure(kMotion, "battery", number_text(s.battery_v, 2) + " V");
}

void add_volume(Rows& rows, const Status::VolumeMoved& volume) {
  rows.heading(kChangeOrPath, "VOLUME MOVED");
  rows.figure(kChangeOrPath, "moved", volume_text(volume.moved_m3));
  rows.figure(kChangeOrPath, "cut, fill",
              volume_text(volume.cut_m3) + ",  " + volume_text(volume.fill_m3));
  rows.figure(kAttitude, "deepest cut", number_text(volume.deepest_cut_m * 1e3, 1) + " mm");
  rows.figure(kAttitude, "deepest fill", number_text(volume.deepest_fill_m * 1e3, 1) + " mm");
}

void add_slopes(Rows& rows, const Status::Terrain& s) {
  rows.heading(kDetail, "SLOPES", s.loose ? "start" : "", s.loose ? "now" : "");
  const auto row = [&](int importance, const std::string& what, const std::string& before,
                       const std::string& now) {
    rows.figure(importance, what, now, s.loose ? before : "");
  };
  row(kDetail, "mean", degrees(s.before.mean_deg, 2), degrees(s.now.mean_deg, 2));
  row(kSpare, "95 % below", degrees(s.before.p95_deg), degrees(s.now.p95_deg));
  row(kSpare, "steepest", degrees(s.before.steepest_deg), degrees(s.now.steepest_deg));
  row(kDetail, "flat (to " + number_text(s.flat_limit_deg, 0) + "\u00b0)",
      number_text(s.before.flat * 100.0, 1) + " %", number_text(s.now.flat * 100.0, 1) + " %");
}

void add_leveling(Rows& rows, const Status::Leveling& before, const Status::Leveling& now) {
  rows.heading(kDetail, "AT ROBOT SCALE", "start", "now");
  const auto millimetres = [](double metres) { return number_text(metres * 1e3, 1) + " mm"; };
  const auto percent = [](double share) { return number_text(share * 100.0, 1) + " %"; };
  rows.figure(kDetail, "about level", millimetres(now.level_deviation_m),
              millimetres(before.level_deviation_m));
  rows.figure(kSpare, "roughness", millimetres(now.roughness_m), millimetres(before.roughness_m));
  rows.figure(kDetail, "flat", percent(now.flat), percent(before.flat));
  if (now.progress) rows.figure(kDetail, "progress", percent(*now.progress));
}

void add_path(Rows& rows, const Status& s) {
  rows.heading(kChangeOrPath, "DRIVEN PATH");
  for (size_t state = 0; state < kLevelingStates; ++state) {
    if ((s.states_seen >> state & 1U) == 0) continue;
    const bool now = static_cast<int>(state) == s.leveling_state;
    rows.add(kChangeOrPath, 20.0, leveling_state_name(static_cast<message::LevelingState>(state)),
             {.size_px = kText_px, .color = now ? kPaleInk : kFaintInk, .bold = now})
        .swatch = state_color(state);
  }
}

double height_of(const std::vector<Row>& rows) {
  double height = 0.0;
  for (const Row& row : rows) height += row.height_px;
  return height;
}

/// Leaves out the least important rows until the rest fits. Returns whether any is missing.
bool drop_rows(std::vector<Row>& rows, double room_px, double more_px) {
  bool dropped = false;
  for (int importance = kSpare; importance > kAlways; --importance) {
    if (height_of(rows) + (dropped ? more_px : 0.0) <= room_px) break;
    const size_t before = rows.size();
    std::erase_if(rows, [&](const Row& row) { return row.importance == importance; });
    dropped = dropped || rows.size() < before;
  }
  return dropped;
}

/// Puts the words of a row side by side: smaller where they are too wide together, the left ones
/// elided where that is not enough.
void place_words(PanelLayout& panel, const Row& row, double scale, double y,
                 const Measure& measure) {
  constexpr double kGap_px = 8.0;
  constexpr double kMiddleColumn = 0.68;  // where the middle words end
  const double left = panel.left + (row.dot || row.swatch ? (row.dot ? 22.0 : 30.0) * scale : 0.0);
  const double room = panel.right - left;
  Row::Words words[3] = {row.left, row.middle, row.right};
  double needed = -kGap_px;
  for (Row::Words& part : words) {
    part.style.size_px *= scale;
    if (!part.text.empty()) needed += measure(part.text, part.style) + kGap_px;
  }
  const double smaller = needed > room ? room / needed : 1.0;
  for (Row::Words& part : words) {
    part.style.size_px =
        std::max(part.style.size_px * smaller, std::min(part.style.size_px, kMinText_px));
  }
  double taken = panel.right + kGap_px;
  const auto add = [&](const std::string& text, const TextStyle& style, double x) {
    const TextItem item = text_item({x, y}, text, style, measure);
    taken = std::min(taken, item.box.left);
    panel.texts.push_back(item);
  };
  if (!words[2].text.empty()) {
    add(elided(words[2].text, words[2].style, room, measure), words[2].style, panel.right);
  }
  if (!words[1].text.empty()) {
    const double column = panel.left + kMiddleColumn * (panel.right - panel.left);
    add(words[1].text, words[1].style, std::min(column, taken - kGap_px));
  }
  const double width = taken - kGap_px - left;
  if (!words[0].text.empty())
    add(elided(words[0].text, words[0].style, width, measure), words[0].style, left);
}

void place_row(PanelLayout& panel, const Row& row, double scale, double y, const Measure& measure) {
  if (row.dot) {
    const double size = 12.0 * scale;
    panel.marks.push_back({{panel.left, y - 11.0 * scale, size, size}, *row.dot, true});
  }
  if (row.swatch) {
    panel.marks.push_back(
        {{panel.left, y - 7.0 * scale, 20.0 * scale, 4.0 * scale}, *row.swatch, false});
  }
  place_words(panel, row, scale, y, measure);
}

}  // namespace

PanelLayout panel_layout(const Layout& layout, const Status& s, const Measure& measure) {
  const double scale = layout.scale;
  const double margin = std::min(kMargin_px * scale, 0.07 * layout.panel.width);
  PanelLayout panel;
  panel.left = layout.panel.left + margin;
  panel.right = layout.panel.left + layout.panel.width - margin;
  Rows rows(panel.right - panel.left, scale, measure);
  add_head(rows, s);
  add_robot(rows, s.motion);
  if (s.terrain.volume.has_value()) add_volume(rows, *s.terrain.volume);
  add_slopes(rows, s.terrain);
  if (s.terrain.loose && s.leveling_before.has_value() && s.leveling_now.has_value())
    add_leveling(rows, *s.leveling_before, *s.leveling_now);
  add_path(rows, s);
  if (!s.notice.empty()) {
    rows.add(kWho, 8.0, "", {});
    rows.paragraph(kWho, s.notice, {.size_px = 12.5, .color = kAccent});
  }

  constexpr double kTopMargin_px = 10.0;
  constexpr double kFoot_px = 36.0;
  constexpr double kMore_px = 20.0;
  constexpr double kTightRows = 0.82;  // of their full height, before any is left out
  const double room = layout.panel.height / scale - kTopMargin_px - kFoot_px;
  const bool dropped = drop_rows(rows.rows, room / kTightRows, kMore_px);
  if (dropped) rows.add(kAlways, kMore_px, kMore, {.size_px = 12.5, .color = kFaintInk});
  const double pitch = std::min(1.0, room / height_of(rows.rows)) * scale;

  double y = kTopMargin_px * scale;
  for (const Row& row : rows.rows) {
    y += row.height_px * pitch;
    if (row.heading) panel.rules.push_back(y - 20.0 * pitch);
    place_row(panel, row, scale, y, measure);
  }
  Row foot;
  foot.left = {s.keys, {.size_px = 12.5, .color = kFaintInk}};
  place_words(panel, foot, scale, layout.panel.height - 12.0 * scale, measure);
  return panel;
}

void draw_status_panel(Canvas& canvas, const Layout& layout, const Status& s) {
  canvas.rectangle(layout.panel, kBackground);
  const PanelLayout panel =
      panel_layout(layout, s, [&](const std::string& words, const TextStyle& style) {
        return canvas.text_width(words, style);
      });
  for (const double y : panel.rules) {
    canvas.line(std::array<Pixel, 2>{{{panel.left, y}, {panel.right, y}}}, 1.0, kTrack);
  }
  for (const PanelLayout::Mark& mark : panel.marks) {
    const PixelBox& box = mark.box;
    if (mark.round) {
      canvas.circle({box.left + 0.5 * box.width, box.top + 0.5 * box.height}, 0.5 * box.width,
                    mark.color);
    } else {
      canvas.rectangle(box, mark.color);
    }
  }
  for (const TextItem& text : panel.texts) canvas.text(text.anchor(), text.words, text.style);
}

}  // namespace screed::viewer
