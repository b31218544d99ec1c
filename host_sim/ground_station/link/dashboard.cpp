// The page that `screed monitor` shows.
#include "host_sim/ground_station/link/dashboard.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace screed {
namespace {

constexpr int kColumn = 40;  // width of a box
constexpr int kLabel = 12;   // of a value's name
constexpr uint64_t kStale_us = 1'500'000;
constexpr int kCurveHeight = 5;
constexpr int kAxis = 10;

std::string number(const char* pattern, double value) {
  char text[48];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

std::string clock_text(uint64_t time_us) {
  const auto seconds = static_cast<unsigned long long>(time_us / 1'000'000U % 86400U);
  char text[24];
  std::snprintf(text, sizeof text, "%02llu:%02llu:%02llu", seconds / 3600, seconds / 60 % 60,
                seconds % 60);
  return text;
}

std::string unit_of(std::string_view path) {
  const SignalInfo& signal = *find_signal(path).signal;
  return signal.unit[0] == '\0' ? "" : std::string(" ") + signal.unit;
}

CellStyle style_of_state(const std::string& state) {
  if (state == "running") return CellStyle::kGood;
  if (state == "fault") return CellStyle::kAlarm;
  return CellStyle::kWarning;
}

/// A box of values that is filled line by line.
class Panel {
 public:
  Panel(TextCanvas& page, int x, int y, int height, const char* title)
      : page_(page), x_(x + 2), y_(y + 1) {
    page_.box(x, y, kColumn, height, title);
  }
  void line(std::string_view label, std::string_view value, CellStyle style = CellStyle::kNormal) {
    page_.text(x_, y_, label, CellStyle::kDim);
    page_.text(x_ + kLabel, y_, value, style);
    ++y_;
  }
  void signal(std::string_view label, const RobotView& robot, std::string_view path) {
    line(label, robot.text(path) + (robot.raw(path).has_value() ? unit_of(path) : ""));
  }
  /// A value with a bar that is full at `full`.
  void bar(std::string_view label, const RobotView& robot, std::string_view path, double full,
           double warn) {
    const double value = robot.value(path).value_or(0.0);
    page_.centred_bar(x_ + kLabel + 13, y_, 13, value / full,
                      std::abs(value) >= warn ? CellStyle::kWarning : CellStyle::kGood);
    signal(label, robot, path);
  }

 private:
  TextCanvas& page_;
  int x_;
  int y_;
};

void draw_head(TextCanvas& page, const DashboardInput& input, const RobotView* robot) {
  int x = page.text(0, 0, "screed monitor  ", CellStyle::kTitle);
  x = page.text(x, 0, input.link_name + " ");
  x = page.text(x, 0, input.link.text, input.link.up ? CellStyle::kGood : CellStyle::kAlarm);
  if (robot == nullptr) {
    page.text(x, 0, "   no robot heard yet", CellStyle::kWarning);
    return;
  }
  x = page.text(x, 0, "   " + input.robot.text() + " ");
  const std::string state = robot->text("heartbeat.state");
  const bool stale = input.now_us > robot->last_us() + kStale_us;
  x = page.text(x, 0, state, style_of_state(state));
  if (stale) {
    const double age_s = static_cast<double>(input.now_us - robot->last_us()) * 1e-6;
    x = page.text(x, 0, "  SILENT for " + number("%.1f s", age_s), CellStyle::kAlarm);
  }
  if (input.fleet->robots().size() > 1) {
    page.text(x, 0, "   (" + std::to_string(input.fleet->robots().size()) + " robots, Tab)",
              CellStyle::kDim);
  }
}

std::string loss_text(const RobotView& robot, uint64_t now_us) {
  const std::optional<double> loss = robot.loss_percent(now_us);
  return loss.has_value() ? number("%.1f %%", *loss) : "-";
}

std::string refused_text(const DashboardInput& input) {
  return std::to_string(input.link.refused + input.fleet->damaged()) + " damaged, " +
         std::to_string(input.fleet->unknown()) + " unknown";
}

void draw_values(TextCanvas& page, const DashboardInput& input, const RobotView& robot) {
  constexpr int kTop = 1;
  constexpr int kHeight = 6;
  const int columns = std::max(1, page.width() / kColumn);
  int place = 0;
  const auto panel = [&](const char* title) {
    const int x = place % columns * kColumn;
    const int y = kTop + place / columns * kHeight;
    ++place;
    return Panel(page, x, y, kHeight, title);
  };

  Panel attitude = panel("attitude");
  attitude.bar("roll", robot, "attitude.roll", 45.0, 30.0);
  attitude.bar("pitch", robot, "attitude.pitch", 45.0, 30.0);
  attitude.signal("heading", robot, "attitude.heading");

  Panel odometry = panel("odometry");
  odometry.signal("x (east)", robot, "odometry.x");
  odometry.signal("y (north)", robot, "odometry.y");
  odometry.line("from start", number("%.2f m", std::hypot(robot.value("odometry.x").value_or(0.0),
                                                          robot.value("odometry.y").value_or(0.0)) *
                                                   1e-3));
  odometry.line("encoders", robot.text("encoders.left") + "  " + robot.text("encoders.right"));

  Panel motors = panel("motors");
  motors.bar("left", robot, "motors.duty_left", 100.0, 90.0);
  motors.bar("right", robot, "motors.duty_right", 100.0, 90.0);
  motors.signal("battery", robot, "power.battery");
  motors.signal("CPU load", robot, "power.cpu_load");

  Panel algorithm = panel("algorithm");
  algorithm.line("algorithm", robot.text("leveling.algorithm"));
  const bool stuck = robot.value("motors.stuck").value_or(0.0) != 0.0;
  const bool slips = robot.value("motors.slip").value_or(0.0) != 0.0;
  algorithm.line("doing",
                 robot.text("leveling.state") + (stuck   ? ", STUCK"
                                                 : slips ? ", tracks slip"
                                                         : ""),
                 stuck   ? CellStyle::kAlarm
                 : slips ? CellStyle::kWarning
                         : CellStyle::kTitle);
  algorithm.line("speed, turn", robot.text("leveling.speed") + " mm/s, " +
                                    robot.text("leveling.turn_rate") + " deg/s");
  algorithm.line("peaks", robot.text("leveling.peaks"));

  Panel link = panel("link");
  link.line("down", number("%.0f frames/s, lost ", robot.frames_per_s(input.now_us)) +
                        loss_text(robot, input.now_us));
  const bool alive = robot.value("heartbeat.link_alive").value_or(0.0) != 0.0;
  const std::optional<double> up = robot.value("link.quality");
  link.line("up",
            std::string(alive ? "alive" : "no ground station heard") +
                (up.has_value() && alive ? number(", hears %.0f %%", *up) : ""),
            alive ? CellStyle::kGood : CellStyle::kWarning);
  link.line("refused", refused_text(input));
  const std::optional<int> rssi_dbm = robot.rssi_dbm();
  link.line("strength", rssi_dbm.has_value() ? std::to_string(*rssi_dbm) + " dBm" : "-");

  Panel faults = panel("faults");
  const std::vector<std::string> words = robot.faults();
  if (words.empty()) faults.line("none", "");
  for (size_t i = 0; i < words.size() && i < kHeight - 2; ++i) {
    const bool more = i == kHeight - 3 && words.size() > i + 1;
    faults.line("", "", CellStyle::kAlarm);
    const int x = (place - 1) % columns * kColumn + 2;
    const int y = kTop + (place - 1) / columns * kHeight + 1 + static_cast<int>(i);
    const std::string line = more ? "and " + std::to_string(words.size() - i) + " more" : words[i];
    page.text(x, y, from_utf8(line).size() > kColumn - 4 ? line.substr(0, kColumn - 5) + "…" : line,
              CellStyle::kAlarm);
  }
}

int draw_curve(TextCanvas& page, int y, const DashboardInput& input, const RobotView& robot,
               const std::string& path) {
  const SignalRef place = find_signal(path);
  const std::vector<CurvePoint> points = robot.curve(place, input.now_us, input.window_s);
  double low = 0.0;
  double high = 0.0;
  if (!points.empty()) {
    const auto [least, most] =
        std::minmax_element(points.begin(), points.end(),
                            [](const CurvePoint& a, const CurvePoint& b) { return a.y < b.y; });
    low = least->y;
    high = most->y;
  }
  if (high - low < 1e-9) {  // a flat line runs in the middle
    low -= 1.0;
    high += 1.0;
  }
  page.box(0, y, page.width(), kCurveHeight + 2,
           path + unit_of(path) + ", " + number("%.0f s", input.window_s));
  page.text(2, y + 1, number("%.5g", high), CellStyle::kDim);
  page.text(2, y + kCurveHeight, number("%.5g", low), CellStyle::kDim);
  page.curve(kAxis, y + 1, page.width() - kAxis - 2, kCurveHeight, points,
             {-input.window_s, 0.0, low, high});
  if (!points.empty())
    page.text(page.width() - 14, y, number(" %.5g ", points.back().y), CellStyle::kTitle);
  return y + kCurveHeight + 2;
}

}  // namespace

void draw_dashboard(TextCanvas& page, const DashboardInput& input) {
  const auto found = input.fleet->robots().find(input.robot);
  const RobotView* const robot = found == input.fleet->robots().end() ? nullptr : &found->second;
  draw_head(page, input, robot);
  page.text(0, page.height() - 1, input.footer, CellStyle::kDim);
  if (robot == nullptr) return;
  draw_values(page, input, *robot);

  const int columns = std::max(1, page.width() / kColumn);
  int y = 1 + (6 + columns - 1) / columns * 6;
  for (const std::string& path : input.curves) {
    if (y + kCurveHeight + 2 > page.height() - 1) break;
    y = draw_curve(page, y, input, *robot, path);
  }
  for (const RobotView::Event& event : robot->events()) {
    if (y >= page.height() - 1) break;
    const int x = page.text(0, y, clock_text(event.time_us) + "  ", CellStyle::kDim);
    page.text(x, y++, event.words, event.style);
  }
}

std::string plain_report(const DashboardInput& input) {
  std::string report = "link " + input.link_name + ": " + input.link.text + ", " +
                       std::to_string(input.link.received) + " frames, " + refused_text(input) +
                       "\n";
  for (const auto& [key, robot] : input.fleet->robots()) {
    report += key.text() + ": " + robot.text("heartbeat.state");
    if (const auto rssi_dbm = robot.rssi_dbm()) report += ", " + std::to_string(*rssi_dbm) + " dBm";
    report += ", " + std::to_string(robot.frames()) + " frames, " + std::to_string(robot.lost()) +
              " lost\n";
    for (const std::string& fault : robot.faults()) report += "  fault: " + fault + "\n";
    for (const MessageInfo& message : messages()) {
      const std::deque<RobotView::Sample>& samples = robot.history(message);
      if (samples.empty()) continue;
      report += "  " + std::string(message.title) + ":";
      for (const SignalInfo& signal : message.signals) {
        if (signal.role != SignalRole::kData || signal.flags[0] != '\0') continue;
        report += std::string(" ") + signal.name + " " +
                  signal.text(signal.raw(samples.front().data.data())) +
                  (signal.unit[0] == '\0' ? "" : std::string(" ") + signal.unit);
      }
      report += "\n";
    }
  }
  return report;
}

}  // namespace screed
