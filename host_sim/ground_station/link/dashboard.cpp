// The page that `screed monitor` shows: its layouts.
#include "host_sim/ground_station/link/dashboard.h"

#include <algorithm>
#include <cstdio>

#include "host_sim/ground_station/link/dashboard_rows.h"

namespace screed {
namespace {

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
                   (lost ? "LINK LOST  " : "") + input.link_name + " " + input.link.text,
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
                       std::to_string(input.link.received) + " frames, " + refused_text(input) +
                       "\n";
  for (const auto& [key, robot] : input.fleet->robots()) {
    report += key.text() + ": " + robot.text("heartbeat.state");
    if (link_lost(input, robot)) {
      const double age_s = static_cast<double>(input.now_us - robot.last_us()) * 1e-6;
      report += ", SILENT for " + number("%.1f s", age_s);
    }
    if (const auto rssi_dbm = robot.rssi_dbm()) report += ", " + std::to_string(*rssi_dbm) + " dBm";
    report += ", " + std::to_string(robot.frames()) + " frames, " + std::to_string(robot.lost()) +
              " lost\n";
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
                  signal.text(signal.raw(samples.front().data.data())) +
                  (signal.unit[0] == '\0' ? "" : std::string(" ") + signal.unit);
      }
      report += "\n";
    }
  }
  return report;
}

}  // namespace screed
