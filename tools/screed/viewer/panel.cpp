// Rows of figures.
#include "tools/screed/viewer/panel.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "host_sim/render/picture/map_frame.h"
#include "host_sim/run/simulation/names.h"
#include "tools/screed/viewer/style.h"

namespace screed::viewer {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kMargin_px = 22.0;
constexpr double kRow_px = 22.0;
constexpr double kText_px = 14.0;

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

/// Writes from the top to the bottom of the panel.
class Writer {
 public:
  explicit Writer(Canvas& canvas)
      : canvas_(canvas),
        left_(canvas.width() - kPanelWidth_px + kMargin_px),
        right_(canvas.width() - kMargin_px) {}

  double y = 40.0;

  /// Text that is set smaller when it is too long.
  void line(const std::string& words, TextStyle style) {
    const double width = canvas_.text_width(words, style);
    if (width > right_ - left_) style.size_px *= (right_ - left_) / width;
    canvas_.text({left_, y}, words, style);
  }
  void right(const std::string& words, TextStyle style) {
    style.align = TextAlign::kRight;
    canvas_.text({right_, y}, words, style);
  }
  void heading(const std::string& words) {
    y += 16.0;
    const std::array<Pixel, 2> rule = {{{left_, y - 20.0}, {right_, y - 20.0}}};
    canvas_.line(rule, 1.0, kTrack);
    y += 4.0;
    line(words, {.size_px = 12.0, .color = kFaintInk, .bold = true});
    y += kRow_px;
  }
  void row(const std::string& name, const std::string& value, Color color = kPaleInk) {
    line(name, {.size_px = kText_px, .color = kFaintInk});
    right(value, {.size_px = kText_px, .color = color});
    y += kRow_px;
  }
  /// Two values, the first one fainter.
  void row(const std::string& name, const std::string& before, const std::string& now) {
    canvas_.text({right_ - 72.0, y}, before,
                 {.size_px = kText_px, .color = kFaintInk, .align = TextAlign::kRight});
    row(name, now);
  }
  void columns(const std::string& before, const std::string& now) {
    const TextStyle style{.size_px = 12.0, .color = kFaintInk, .align = TextAlign::kRight};
    canvas_.text({right_ - 72.0, y}, before, style);
    canvas_.text({right_, y}, now, style);
  }
  void dot(Color color) { canvas_.circle({left_ + 6.0, y - 5.0}, 6.0, color); }
  void beside_dot(const std::string& words, TextStyle style) {
    canvas_.text({left_ + 22.0, y}, words, style);
  }
  void swatch(Color color) {
    canvas_.line(std::array<Pixel, 2>{{{left_ + 2.0, y - 5.0}, {left_ + 20.0, y - 5.0}}}, 4.0,
                 color);
  }
  void beside_swatch(const std::string& words, TextStyle style) {
    canvas_.text({left_ + 32.0, y}, words, style);
  }
  /// As many lines as the words need.
  void paragraph(const std::string& words, const TextStyle& style) {
    std::string rest = words;
    while (!rest.empty()) {
      size_t end = rest.size();
      while (end > 0 && canvas_.text_width(rest.substr(0, end), style) > right_ - left_) {
        const size_t blank = rest.rfind(' ', end - 1);
        if (blank == std::string::npos) break;
        end = blank;
      }
      line(rest.substr(0, end), style);
      rest = end < rest.size() ? rest.substr(end + 1) : "";
      y += 18.0;
    }
  }

 private:
  Canvas& canvas_;
  double left_;
  double right_;
};

void write_robot(Writer& writer, const Status::Motion& s) {
  writer.heading("ROBOT");
  const auto speed = [](double value) { return number_text(value * 1e3, 0) + " mm/s"; };
  writer.row("speed", speed(s.speed_m_per_s));
  writer.row("turning", degrees(s.turn_rad_per_s * kDegPerRad, 0) + "/s");
  writer.row("wanted",
             speed(s.wanted_m_per_s) + ",  " + degrees(s.wanted_rad_per_s * kDegPerRad, 0) + "/s");
  writer.row("pitch, roll",
             degrees(s.pitch_rad * kDegPerRad) + ",  " + degrees(s.roll_rad * kDegPerRad));
  writer.row("heading", degrees(s.heading_rad * kDegPerRad, 0));
  writer.row("slip left, right", number_text(s.slip_left * 100.0, 0) + ",  " +
                                     number_text(s.slip_right * 100.0, 0) + " %");
  if (s.sinkage_m) writer.row("sinkage", number_text(*s.sinkage_m * 1e3, 1) + " mm");
  writer.row("battery", number_text(s.battery_v, 2) + " V");
}

void write_terrain(Writer& writer, const Status& s) {
  writer.heading("SLOPES");
  writer.y -= kRow_px;
  if (s.terrain.loose) writer.columns("start", "now");
  writer.y += kRow_px;
  const auto row = [&](const std::string& name, const std::string& before, const std::string& now) {
    if (s.terrain.loose) {
      writer.row(name, before, now);
    } else {
      writer.row(name, now);
    }
  };
  const SlopeFigures& before = s.terrain.before;
  const SlopeFigures& now = s.terrain.now;
  row("mean", degrees(before.mean_deg, 2), degrees(now.mean_deg, 2));
  row("95 % below", degrees(before.p95_deg), degrees(now.p95_deg));
  row("steepest", degrees(before.steepest_deg), degrees(now.steepest_deg));
  row("flat (" + number_text(s.terrain.flat_limit_deg, 0) + "\u00b0)",
      number_text(before.flat * 100.0, 1) + " %", number_text(now.flat * 100.0, 1) + " %");
}

void write_path(Writer& writer, const Status& s) {
  writer.heading("DRIVEN PATH");
  for (size_t state = 0; state < kLevelingStates; ++state) {
    if ((s.states_seen >> state & 1U) == 0) continue;
    writer.swatch(state_color(state));
    const bool now = static_cast<int>(state) == s.leveling_state;
    writer.beside_swatch(leveling_state_name(static_cast<LevelingState>(state)),
                         {.size_px = kText_px, .color = now ? kPaleInk : kFaintInk, .bold = now});
    writer.y += kRow_px - 2.0;
  }
}

}  // namespace

void draw_status_panel(Canvas& canvas, const Status& s) {
  canvas.rectangle(
      {canvas.width() - kPanelWidth_px, 0.0, kPanelWidth_px, static_cast<double>(canvas.height())},
      kBackground);
  Writer writer(canvas);
  writer.line(s.title, {.size_px = 19.0, .color = kPaleInk, .bold = true});
  writer.y += 20.0;
  writer.line(s.subtitle, {.size_px = 12.5, .color = kFaintInk});
  writer.y += 40.0;
  writer.line(clock_text(s.time_s), {.size_px = 32.0, .color = kPaleInk, .bold = true});
  writer.right(s.pace, {.size_px = 16.0, .color = kAccent, .bold = true});
  writer.y += 19.0;
  writer.line("of " + clock_text(s.duration_s), {.size_px = 12.5, .color = kFaintInk});
  writer.y += 30.0;
  writer.dot(robot_state_color(s.state));
  const auto state = static_cast<RobotState>(s.state);
  std::string words = state_name(state);
  if (state == RobotState::kRunning) {
    words += std::string(": ") + leveling_state_name(static_cast<LevelingState>(s.leveling_state));
  }
  writer.beside_dot(words, {.size_px = 16.0, .color = kPaleInk, .bold = true});
  writer.y += 24.0;
  if (s.faults != 0) {
    writer.paragraph("faults: " + fault_names(static_cast<uint16_t>(s.faults)),
                     {.size_px = kText_px, .color = kAlarm, .bold = true});
  } else {
    writer.line("no faults", {.size_px = kText_px, .color = kFaintInk});
    writer.y += kRow_px;
  }
  if (!s.driver.empty()) {
    writer.paragraph(s.driver, {.size_px = kText_px, .color = kAccent, .bold = true});
  }
  write_robot(writer, s.motion);
  write_terrain(writer, s);
  write_path(writer, s);
  if (!s.notice.empty()) {
    writer.y += 8.0;
    writer.paragraph(s.notice, {.size_px = 12.5, .color = kAccent});
  }
  writer.y = canvas.height() - 17.0;
  writer.line("H  keys", {.size_px = 12.5, .color = kFaintInk});
}

}  // namespace screed::viewer
