// The page that `screed monitor` shows: rows of values, and their layouts.
#include "host_sim/ground_station/link/dashboard.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "firmware/protocol/messages.h"
#include "host_sim/core/figures.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "host_sim/ground_station/telemetry/battery_charge.h"
#include "host_sim/ground_station/telemetry/track_slip.h"

namespace screed {

namespace {

// What the dashboard says of a robot, before it is laid out: values in words, with their age, in
// groups, each with its importance for pages that have no room for all.

/// Of the row with the slip of both tracks, which no message carries.
constexpr const char* kSlipLabel = "slip l, r";

struct DashboardBar {
  double value;  ///< -1..1
  bool warn;
};

struct DashboardRow {
  int importance;     ///< the smaller, the more important
  std::string label;  ///< empty: the value takes the whole width
  std::string value;
  CellStyle style = CellStyle::kNormal;
  std::optional<DashboardBar> bar = {};
};

struct DashboardGroup {
  std::string title;
  std::vector<DashboardRow> rows;
};

constexpr uint64_t kOld_us = 1'000'000;

/// A value as printf writes it.
std::string number(const char* pattern, double value) {
  char text[48];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

/// Nothing has come from the robot for a second, or the link is down: everything shown is history.
bool link_lost(const DashboardInput& input, const RobotHistory& robot) {
  return !input.link.up || input.now_us > robot.last_us() + kOld_us;
}

}  // namespace

bool is_old(const RobotHistory& robot, const MessageInfo& message, uint64_t now_us) {
  const LatestTelemetry::Frame* const last = robot.latest().frame(message);
  if (last == nullptr) return false;
  const uint64_t period_us = uint64_t{message.period_ms} * 1000U;
  return now_us > last->time_us + std::max(kOld_us, period_us + period_us / 2);
}

std::string age_text(double age_s) {
  if (age_s < 60.0) return number("%.0f s", std::floor(age_s));
  if (age_s < 3600.0) return number("%.0f min", std::floor(age_s / 60.0));
  return number("%.0f h", std::floor(age_s / 3600.0));
}

namespace {

/// "3 damaged, 0 unknown".
std::string refused_text(const DashboardInput& input) {
  return std::to_string(input.link.refused + input.fleet->damaged()) + " damaged, " +
         std::to_string(input.fleet->unknown()) + " unknown";
}

/// Makes rows of one robot at one time. A row belongs to the message that carries its value.
class RowMaker {
 public:
  RowMaker(const DashboardInput& input, const RobotHistory& robot) : input_(input), robot_(robot) {}

  DashboardRow row(int importance, const char* label, const char* message, std::string value,
                   CellStyle style = CellStyle::kNormal) const {
    const MessageInfo& carrier = *find_message(message);
    const std::optional<double> age_s = robot_.latest().age_s(carrier, input_.now_us);
    if (!age_s.has_value()) return {importance, label, "-", CellStyle::kDim};
    // Without a link a value is history at once.
    const bool old = !input_.link.up || is_old(robot_, carrier, input_.now_us);
    if (!old) return {importance, label, std::move(value), style};
    value += " (" + age_text(*age_s) + ")";
    return {importance, label, std::move(value), CellStyle::kDim};
  }

  /// A signal in its unit.
  DashboardRow signal(int importance, const char* label, const char* path) const {
    const SignalRef place = find_signal(path);
    const std::optional<int64_t> raw = robot_.raw(path);
    return row(importance, label, place.message->name,
               raw.has_value() ? display_name(place.signal->shown(*raw)) : "-");
  }

  /// A signal with a bar that is full at `full` and warns from `warn` on.
  DashboardRow bar(int importance, const char* label, const char* path, double full,
                   double warn) const {
    DashboardRow made = signal(importance, label, path);
    const double value = robot_.value(path).value_or(0.0);
    if (made.style != CellStyle::kDim) made.bar = {value / full, std::abs(value) >= warn};
    return made;
  }

  bool flag(const char* path) const { return robot_.value(path).value_or(0.0) != 0.0; }

 private:
  const DashboardInput& input_;
  const RobotHistory& robot_;
};

DashboardRow battery_row(const DashboardInput& input, const RobotHistory& robot,
                         const RowMaker& make) {
  const double battery_v = robot.value("power.battery").value_or(0.0) * 1e-3;
  const std::optional<double> charge = battery_charge(battery_v, input.battery_cells);
  std::string text = battery_text(battery_v, input.battery_cells);
  // The robot knows its limit; the charge warns before.
  const bool below_limit = make.flag("heartbeat.battery");
  const bool low = charge.has_value() && *charge < kLowCharge;
  if (below_limit) text += "  TOO LOW";
  if (low && !below_limit) text += "  LOW";
  return make.row(1, "battery", "POWER", std::move(text),
                  below_limit ? CellStyle::kAlarm
                  : low       ? CellStyle::kWarning
                              : CellStyle::kNormal);
}

/// How well it knows where it is: standard deviations.
DashboardRow certainty_row(const RobotHistory& robot, const RowMaker& make) {
  return make.row(11, "certain to", "POSITION",
                  robot.text("position.sigma_x") + ", " + robot.text("position.sigma_y") + " mm, " +
                      robot.text("position.sigma_heading") + " deg");
}

/// Slip with the newest POSITION, from what was said in the second before.
std::optional<TrackSlip> newest_slip(const RobotHistory& robot, const BoardConstants& board) {
  const MessageInfo* const position = find_message("POSITION");
  if (robot.history(*position).empty()) return std::nullopt;
  const RobotHistory::Sample& newest = robot.history(*position).front();
  TrackSlipEstimate estimate(board);
  for (const char* name : {"ENCODERS", "ODOMETRY"}) {
    const MessageInfo& message = *find_message(name);
    const auto& samples = robot.history(message);  // the newest first
    const auto older = std::find_if(samples.begin(), samples.end(), [&](const auto& sample) {
      return sample.time_us + 2 * TrackSlipEstimate::kWindow_us < newest.time_us;
    });
    for (auto it = std::make_reverse_iterator(older); it != samples.rend(); ++it) {
      if (it->time_us <= newest.time_us)
        estimate.add(it->time_us, message, message_bits(it->data.data()));
    }
  }
  return estimate.add(newest.time_us, *position, message_bits(newest.data.data()));
}

DashboardRow slip_row(const DashboardInput& input, const RobotHistory& robot,
                      const RowMaker& make) {
  const auto text = [](const std::optional<double>& slip) {
    return slip.has_value() ? number("%.0f %%", *slip * 100.0) : "-";
  };
  const std::optional<TrackSlip> slip =
      input.board == nullptr ? std::nullopt : newest_slip(robot, *input.board);
  return make.row(8, kSlipLabel, "POSITION",
                  slip.has_value() ? text(slip->left) + ", " + text(slip->right) : "-");
}

DashboardGroup algorithm_group(const RobotHistory& robot, const RowMaker& make) {
  const bool stuck = make.flag("motors.stuck");
  const bool slips = make.flag("motors.slip");
  return {"algorithm",
          {make.row(11, "algorithm", "LEVELING", robot.text("leveling.algorithm")),
           make.row(2, "doing", "LEVELING",
                    robot.text("leveling.state") + (stuck   ? ", STUCK"
                                                    : slips ? ", tracks slip"
                                                            : ""),
                    stuck   ? CellStyle::kAlarm
                    : slips ? CellStyle::kWarning
                            : CellStyle::kTitle),
           make.row(5, "speed, turn", "LEVELING",
                    robot.text("leveling.speed") + " mm/s, " + robot.text("leveling.turn_rate") +
                        " deg/s"),
           make.row(16, "peaks", "LEVELING", robot.text("leveling.peaks"))}};
}

DashboardGroup link_group(const DashboardInput& input, const RobotHistory& robot,
                          const RowMaker& make) {
  const std::optional<double> loss = robot.loss_percent(input.now_us);
  const bool silent = link_lost(input, robot);
  const bool alive = make.flag("heartbeat.link_alive");
  const std::optional<double> quality = robot.value("link.quality");
  const std::optional<int> rssi_dbm = robot.rssi_dbm();
  return {"link",
          {{8, "down",
            number("%.0f frames/s, lost ", robot.frames_per_s(input.now_us)) +
                (loss.has_value() ? number("%.1f %%", *loss) : "-"),
            silent ? CellStyle::kAlarm : CellStyle::kNormal},
           make.row(3, "up", "HEARTBEAT",
                    !alive                 ? "no ground station heard"
                    : !quality.has_value() ? "alive"
                                           : number("alive, hears %.0f %%", *quality),
                    alive ? CellStyle::kGood : CellStyle::kAlarm),
           {14, "refused", refused_text(input)},
           {15, "strength", rssi_dbm.has_value() ? std::to_string(*rssi_dbm) + " dBm" : "-"}}};
}

/// Latched faults, or what keeps a disarmed robot from being armed.
DashboardGroup fault_group(const DashboardInput& input, const RobotHistory& robot) {
  const bool disarmed =
      robot.raw("heartbeat.state") == static_cast<int64_t>(message::HeartbeatState::kDisarmed);
  const std::vector<std::string> sentences =
      disarmed ? robot.obstacles(input.now_us) : robot.faults();
  DashboardGroup group{disarmed && !sentences.empty() ? "cannot be armed" : "faults", {}};
  const bool old = !input.link.up || is_old(robot, *find_message("HEARTBEAT"), input.now_us);
  const CellStyle style = old        ? CellStyle::kDim
                          : disarmed ? CellStyle::kWarning
                                     : CellStyle::kAlarm;
  for (const std::string& sentence : sentences) group.rows.push_back({0, "", sentence, style});
  if (sentences.empty()) {
    const CellStyle calm = old ? CellStyle::kDim : CellStyle::kGood;
    group.rows.push_back({10, "", disarmed ? "none; can be armed" : "none", calm});
  }
  return group;
}

/// The groups, in the order of the page.
std::vector<DashboardGroup> dashboard_groups(const DashboardInput& input,
                                             const RobotHistory& robot) {
  const RowMaker make(input, robot);
  const double distance_m =
      std::hypot(robot.value("odometry.x").value_or(0.0), robot.value("odometry.y").value_or(0.0)) *
      1e-3;
  return {{"attitude",
           {make.bar(4, "roll", "attitude.roll", 45.0, 30.0),
            make.bar(4, "pitch", "attitude.pitch", 45.0, 30.0),
            make.signal(7, "heading", "attitude.heading")}},
          {"odometry",
           {make.signal(10, "x (east)", "odometry.x"), make.signal(10, "y (north)", "odometry.y"),
            make.row(9, "from start", "ODOMETRY", number("%.2f m", distance_m)),
            certainty_row(robot, make),
            make.row(13, "encoders", "ENCODERS",
                     robot.text("encoders.left") + "  " + robot.text("encoders.right"))}},
          {"motors",
           {make.bar(6, "left", "motors.duty_left", 100.0, 90.0),
            make.bar(6, "right", "motors.duty_right", 100.0, 90.0), slip_row(input, robot, make),
            battery_row(input, robot, make), make.signal(12, "CPU load", "power.cpu_load")}},
          algorithm_group(robot, make),
          link_group(input, robot, make),
          fault_group(input, robot)};
}

// The layouts.

constexpr int kColumn = 40;  // width of a box
constexpr int kBox = 6;      // its height: four rows
constexpr int kLabel = 12;   // of a value's name
constexpr int kBarWidth = 11;
constexpr int kCurveHeight = 5;
constexpr int kAxis = 10;

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

/// The state first: a long name of the link may be cut.
void draw_head(TextCanvas& page, const DashboardInput& input, const RobotHistory* robot) {
  const bool lost = !input.link.up || (robot != nullptr && link_lost(input, *robot));
  const CellStyle link_style = lost ? CellStyle::kAlarm : CellStyle::kGood;
  int x = 0;
  if (robot == nullptr) {
    x = page.text(0, 0, "no robot heard yet", lost ? CellStyle::kAlarm : CellStyle::kWarning);
  } else {
    const std::string state = robot->text("heartbeat.state");
    x = page.text(0, 0, input.robot.text() + (lost ? " was " : " "),
                  lost ? CellStyle::kAlarm : CellStyle::kTitle);
    x = page.text(x, 0, state, lost ? CellStyle::kAlarm : style_of_state(state));
    if (lost) {
      const double age_s = static_cast<double>(input.now_us - robot->last_us()) * 1e-6;
      x = page.text(x, 0, ", SILENT for " + number("%.1f s", age_s), CellStyle::kAlarm);
    }
    if (input.fleet->robots().size() > 1) {
      x = page.text(x, 0, "  (" + std::to_string(input.fleet->robots().size()) + " robots, Tab)",
                    CellStyle::kDim);
    }
  }
  page.text_within(x + 2, 0, page.width() - x - 2,
                   (lost ? "LINK LOST  " : "") + input.link_name + " " + input.link.text +
                       (input.link.hint.empty() ? "" : "; " + input.link.hint),
                   link_style);
}

void draw_footer(TextCanvas& page, const DashboardInput& input) {
  if (page.height() < 2) return;
  int x = 0;
  for (const std::string& part : input.footer) {
    const int width = static_cast<int>(from_utf8(part).size());
    if (x + width > page.width()) continue;
    x = page.text(x, page.height() - 1, part, CellStyle::kDim) + 2;
  }
}

/// Says on a line of its own that something has no room.
void draw_cut(TextCanvas& page, int y, const std::string& what) {
  page.text_within(0, y, page.width(), what, CellStyle::kWarning);
}

/// The rows of a group that is lines of text, broken to fit its box; the last line says when there
/// is more.
std::vector<DashboardRow> broken(const std::vector<DashboardRow>& rows, int width, size_t height) {
  std::vector<DashboardRow> lines;
  for (const DashboardRow& row : rows) {
    for (std::string& line : break_lines(row.value, width))
      lines.push_back({row.importance, "", std::move(line), row.style});
  }
  if (lines.size() > height) {
    const size_t hidden = lines.size() - height + 1;
    lines.resize(height);
    lines.back().value = "and " + std::to_string(hidden) + " lines more";
  }
  return lines;
}

void draw_group(TextCanvas& page, int x, int y, const DashboardGroup& group, CellStyle edge) {
  page.box(x, y, kColumn, kBox, group.title, edge);
  const int inside = kColumn - 4;
  const bool text = !group.rows.empty() && group.rows.front().label.empty();
  const std::vector<DashboardRow> rows = text ? broken(group.rows, inside, kBox - 2) : group.rows;
  x += 2;
  for (const DashboardRow& row : rows) {
    ++y;
    const int indent = row.label.empty() ? 0 : kLabel;
    page.text(x, y, row.label, CellStyle::kDim);
    if (row.bar.has_value()) {
      page.centred_bar(x + inside - kBarWidth, y, kBarWidth, row.bar->value,
                       row.bar->warn ? CellStyle::kWarning : CellStyle::kGood);
    }
    page.text_within(x + indent, y, inside - indent, row.value, row.style);
  }
}

int draw_curve(TextCanvas& page, int y, const DashboardInput& input, const RobotHistory& robot,
               const std::string& path, CellStyle edge) {
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
           path + unit_of(path) + ", " + number("%.0f s", input.window_s), edge);
  page.text(2, y + 1, number("%.5g", high), CellStyle::kDim);
  page.text(2, y + kCurveHeight, number("%.5g", low), CellStyle::kDim);
  page.curve(kAxis, y + 1, page.width() - kAxis - 2, kCurveHeight, points,
             {-input.window_s, 0.0, low, high});
  if (!points.empty()) {
    const bool old = is_old(robot, *place.message, input.now_us);
    page.text(page.width() - 14, y, number(" %.5g ", points.back().y),
              old ? CellStyle::kDim : CellStyle::kTitle);
  }
  return y + kCurveHeight + 2;
}

void draw_event(TextCanvas& page, int y, const RobotHistory::Event& event) {
  const int x = page.text(0, y, clock_text(event.time_us) + "  ", CellStyle::kDim);
  page.text_within(x, y, page.width() - x, event.words, event.style);
}

/// Boxes side by side, then curves, then events.
void draw_boxes(TextCanvas& page, const DashboardInput& input, const RobotHistory& robot,
                const std::vector<DashboardGroup>& groups) {
  const CellStyle edge = link_lost(input, robot) ? CellStyle::kAlarm : CellStyle::kDim;
  const int columns = page.width() / kColumn;
  int place = 0;
  for (const DashboardGroup& group : groups) {
    draw_group(page, place % columns * kColumn, 1 + place / columns * kBox, group, edge);
    ++place;
  }
  int y = 1 + (place + columns - 1) / columns * kBox;
  const int footer = page.height() - 1;
  const int curves = static_cast<int>(input.curves.size());
  const int room = std::max(footer - y, 0);
  const bool all = curves * (kCurveHeight + 2) <= room;
  const int shown = all ? curves : std::max(room - 1, 0) / (kCurveHeight + 2);
  for (int i = 0; i < shown; ++i)
    y = draw_curve(page, y, input, robot, input.curves[static_cast<size_t>(i)], edge);
  if (!all) {
    const int needed = page.height() + (curves * (kCurveHeight + 2) - room);
    draw_cut(page, y++,
             std::to_string(curves - shown) + " of " + std::to_string(curves) +
                 " curves have no room: they need " + std::to_string(needed) + " lines");
  }
  for (const RobotHistory::Event& event : robot.events()) {
    if (y >= footer) break;
    draw_event(page, y++, event);
  }
}

/// One value a line, the most important first.
void draw_lines(TextCanvas& page, const DashboardInput& input, const RobotHistory& robot,
                const std::vector<DashboardGroup>& groups) {
  std::vector<DashboardRow> rows;
  for (const DashboardGroup& group : groups)
    rows.insert(rows.end(), group.rows.begin(), group.rows.end());
  std::stable_sort(rows.begin(), rows.end(), [](const DashboardRow& a, const DashboardRow& b) {
    return a.importance < b.importance;
  });
  const CellStyle label = link_lost(input, robot) ? CellStyle::kAlarm : CellStyle::kDim;
  const int footer = std::max(page.height() - 1, 1);
  const int room = footer - 1;
  const auto all = static_cast<int>(rows.size());
  const bool cut = all > room;
  const int shown = cut ? std::max(room - 1, std::min(room, 1)) : all;
  int y = 1;
  for (int i = 0; i < shown; ++i, ++y) {
    const DashboardRow& row = rows[static_cast<size_t>(i)];
    const int indent = row.label.empty() ? 0 : kLabel;
    page.text(0, y, row.label, label);
    page.text_within(indent, y, page.width() - indent, row.value, row.style);
  }
  if (cut && y < footer)
    draw_cut(page, y++, std::to_string(all - shown) + " lines cut: 80 x 21 shows all");
  for (const RobotHistory::Event& event : robot.events()) {
    if (y >= footer) break;
    draw_event(page, y++, event);
  }
}

}  // namespace

void draw_dashboard(TextCanvas& page, const DashboardInput& input) {
  const auto found = input.fleet->robots().find(input.robot);
  const RobotHistory* const robot = found == input.fleet->robots().end() ? nullptr : &found->second;
  draw_head(page, input, robot);
  draw_footer(page, input);
  if (robot == nullptr) return;
  const std::vector<DashboardGroup> groups = dashboard_groups(input, *robot);
  const int columns = page.width() / kColumn;
  const int count = static_cast<int>(groups.size());
  // Head, footer, and a line that says what is cut.
  constexpr int kOtherLines = 3;
  const bool boxes =
      columns >= 2 && kOtherLines + (count + columns - 1) / columns * kBox <= page.height();
  if (boxes) {
    draw_boxes(page, input, *robot, groups);
  } else {
    draw_lines(page, input, *robot, groups);
  }
}

std::string plain_report(const DashboardInput& input) {
  std::string report = "link " + input.link_name + ": " + input.link.text + ", " +
                       counted(input.link.received, "frame") + ", " + refused_text(input) + "\n";
  if (!input.link.hint.empty()) report += "  " + input.link.hint + "\n";
  for (const auto& [key, robot] : input.fleet->robots()) {
    report += key.text() + ": " + robot.text("heartbeat.state");
    if (link_lost(input, robot)) {
      const double age_s = static_cast<double>(input.now_us - robot.last_us()) * 1e-6;
      report += ", SILENT for " + number("%.1f s", age_s);
    }
    if (const auto rssi_dbm = robot.rssi_dbm()) report += ", " + std::to_string(*rssi_dbm) + " dBm";
    report +=
        ", " + counted(robot.frames(), "frame") + ", " + std::to_string(robot.lost()) + " lost\n";
    for (const DashboardGroup& group : dashboard_groups(input, robot)) {
      for (const DashboardRow& row : group.rows) {
        if (row.importance == 0) report += "  " + group.title + ": " + row.value + "\n";
        if (row.label == "battery" || row.label == kSlipLabel)
          report += "  " + row.label + ": " + row.value + "\n";
      }
    }
    for (const MessageInfo& message : messages()) {
      const std::deque<RobotHistory::Sample>& samples = robot.history(message);
      if (samples.empty()) continue;
      report += "  " + std::string(message.title);
      if (message.period_ms != 0 && is_old(robot, message, input.now_us)) {
        const double age_s = robot.latest().age_s(message, input.now_us).value_or(0.0);
        report += " (" + age_text(age_s) + " old)";
      }
      report += ":";
      for (const SignalInfo& signal : message.signals) {
        if (signal.role != SignalRole::kData || signal.flags[0] != '\0') continue;
        report += std::string(" ") + signal.name + " " +
                  signal.shown(signal.raw(samples.front().data.data()));
      }
      report += "\n";
    }
  }
  return report;
}

}  // namespace screed
