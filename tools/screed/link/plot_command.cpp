// `screed plot`.
#include "tools/screed/link/plot_command.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "host_sim/core/errors.h"
#include "host_sim/render/chart/plot_plan.h"
#include "host_sim/render/chart/svg.h"
#include "host_sim/render/picture/color_map.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

/// What the log says of the signals.
struct PlotData {
  std::vector<PlotSignal> signals;
  std::vector<std::map<uint8_t, SignalPoints>> by_robot;  ///< of each signal
  std::set<uint8_t> robots;
  ValueRange time_s;  ///< of all messages
};

PlotData read_log(const PlotOptions& options, std::ostream& err) {
  if (options.to_s.has_value() && *options.to_s < options.from_s) {
    throw InputError("--to " + plain_text(*options.to_s) + ": is before --from " +
                     plain_text(options.from_s));
  }
  PlotData data;
  data.signals.reserve(options.signals.size());
  for (const std::string& path : options.signals) data.signals.emplace_back(path);
  data.by_robot.resize(data.signals.size());
  LogDecoder decoder(options.log);
  DecodedFrame frame;
  while (decoder.next(frame)) {
    const double time_s = static_cast<double>(frame.elapsed_us) / 1e6;
    if (time_s < options.from_s || time_s > options.to_s.value_or(time_s)) continue;
    if (options.robot.has_value() && *options.robot != frame.node) continue;
    data.time_s.add(time_s);
    for (size_t i = 0; i < data.signals.size(); ++i) {
      const PlotSignal& signal = data.signals[i];
      if (&signal.message() != frame.message) continue;
      const int64_t raw = signal.raw(frame.bits);
      SignalPoints& points = data.by_robot[i][frame.node];
      if (signal.is_state()) {
        points.states.push_back({time_s, raw});
      } else {
        points.numbers.push_back({time_s, signal.value(raw)});
      }
      data.robots.insert(frame.node);
    }
  }
  decoder.expect_messages();
  const std::string statistics = decoder.statistics().text();
  if (data.robots.empty()) {
    throw InputError(options.log + ": holds none of these signals in this time; " + statistics);
  }
  if (decoder.statistics().is_odd()) err << options.log << ": " << statistics << "\n";
  return data;
}

/// A line or a row of bands: a signal of a robot.
struct PlotSeries {
  size_t signal;
  uint8_t robot;
};

ChartPanel make_panel(const PlotData& data, const PlannedPanel& plan,
                      const std::vector<PlotSeries>& series, size_t groups) {
  ChartPanel panel;
  for (const size_t which : plan.series) {
    const PlotSignal& signal = data.signals[series[which].signal];
    const SignalPoints& points = data.by_robot[series[which].signal].at(series[which].robot);
    std::string label = signal.path();
    if (data.robots.size() > 1) label += ", robot " + std::to_string(series[which].robot);
    if (plan.of_states) {
      panel.rows.push_back(band_row(signal, label, points.states, data.time_s.high));
    } else {
      const bool occasional = signal.message().period_ms == 0;
      panel.series.push_back({label, thinned(points.numbers, groups), occasional});
      constexpr double kHalfTurn_deg = 180.0;
      if (signal.is_full_turn()) panel.series.back().jump = kHalfTurn_deg;
    }
  }
  if (plan.of_states) return panel;
  const std::string unit = "[" + (plan.unit.empty() ? std::string("1") : plan.unit) + "]";
  panel.title = panel.series.size() == 1 ? panel.series[0].label + " " + unit : unit;
  return panel;
}

}  // namespace

StackedChart plot_chart(const PlotOptions& options, std::ostream& err) {
  const PlotData data = read_log(options, err);
  std::vector<PlotSeries> series;
  std::vector<SeriesKind> kinds;
  std::string missing;
  for (size_t i = 0; i < data.signals.size(); ++i) {
    if (data.by_robot[i].empty()) missing += (missing.empty() ? "" : ", ") + data.signals[i].path();
    for (const auto& [robot, points] : data.by_robot[i]) {
      series.push_back({i, robot});
      kinds.push_back({data.signals[i].unit(), data.signals[i].is_state()});
    }
  }
  if (!missing.empty()) {
    err << "note: " << options.log << " holds no message with " << missing << " in this time\n";
  }
  StackedChart chart;
  chart.title = std::filesystem::path(options.log).filename().string();
  chart.x_label = "time [s]";
  chart.x = data.time_s;
  chart.width_px = options.width_px;
  chart.height_px = options.height_px;
  const auto groups = static_cast<size_t>(options.width_px);
  for (const PlannedPanel& plan : plan_panels(kinds)) {
    chart.panels.push_back(make_panel(data, plan, series, groups));
  }
  return chart;
}

int run_plot(const PlotOptions& options, std::ostream& err) {
  check_picture_name("--out", options.out);
  write_picture(options.out, stacked_chart_svg(plot_chart(options, err)));
  return 0;
}

void register_plot_command(Command& root, Program& program) {
  auto [command, options] = add_subcommand<PlotOptions>(
      root, program, "plot",
      "Plot signals of a radio log over time: a panel for each unit, states as bands",
      [](const PlotOptions& given) { return run_plot(given, std::cerr); });
  command.add_option("LOG", options.log, "Log as written by candump -L; -: standard input")
      ->required();
  command
      .add_option("SIGNALS", options.signals,
                  "Signals to plot, e.g. attitude.pitch leveling.state heartbeat.faults "
                  "(docs/telemetry.md)")
      ->required();
  command.add_option("--out", options.out, "Output picture, .svg or .png")
      ->type_name("FILE")
      ->required();
  add_number(command, "--robot", options.robot, "Plot one robot only", {1, 15});
  add_number(command, "--from", options.from_s, "Start, after the log's first message [s]",
             {0.0, 1e9});
  add_number(command, "--to", options.to_s, "End, after the log's first message [s]", {0.0, 1e9});
  add_number(command, "--width", options.width_px, "Width of the SVG [px]; a PNG has twice as many",
             {kMinChartWidth_px, kMaxChartSide_px});
  add_number(command, "--height", options.height_px,
             "Height of the SVG [px]; a PNG has twice as many (default: what the panels need)",
             {kMinChartHeight_px, kMaxChartSide_px});
}

namespace {

constexpr Color kFlagColor = {0.80, 0.22, 0.16};
constexpr Color kClear = {1.0, 1.0, 1.0, 0.0};

/// Halfway to white: states that are no leveling states look different from those.
Color pale(Color color) {
  const auto half = [](double part) { return 0.5 + 0.5 * part; };
  return {half(color.red), half(color.green), half(color.blue)};
}

Color color_of(const std::string& path, std::int64_t value) {
  const auto index = static_cast<std::size_t>(std::max<std::int64_t>(0, value));
  return path == "leveling.state" ? state_color(index) : pale(category_color(index));
}

}  // namespace

PlotSignal::PlotSignal(const std::string& path) : path_(path) {
  const std::size_t point = path.find('.');
  message_ = find_message(std::string_view(path).substr(0, point));
  if (message_ != nullptr && point != std::string::npos) {
    field_ = path.substr(point + 1);
    std::optional<std::uint8_t> first;
    for (const SignalInfo& it : message_->signals) {
      if (it.flags != field_) continue;
      first = std::min(first.value_or(it.start), it.start);
      mask_ |= std::uint64_t{1} << it.start;
    }
    if (first.has_value()) {
      first_bit_ = *first;
      return;
    }
  }
  const SignalRef found = find_signal(path);
  message_ = found.message;
  signal_ = found.signal;
}

bool PlotSignal::is_state() const {
  return signal_ == nullptr || !signal_->values.empty() || *signal_->flags != '\0';
}

std::int64_t PlotSignal::raw(std::uint64_t bits) const {
  if (signal_ != nullptr) return signal_->raw(bits);
  return static_cast<std::int64_t>((bits & mask_) >> first_bit_);
}

ChartBand PlotSignal::band(const BandInterval& interval) const {
  const std::int64_t value = interval.value;
  ChartBand band{interval.begin, interval.end, "", kFlagColor};
  const bool flags = signal_ == nullptr || *signal_->flags != '\0';
  if (flags) {
    if (value == 0) band.color = kClear;
    if (signal_ == nullptr) {
      band.name = flag_names(message_->title, field_, static_cast<std::uint32_t>(value));
    }
    return band;
  }
  band.name = signal_->text(value);
  band.color = color_of(path_, value);
  return band;
}

BandRow band_row(const PlotSignal& signal, const std::string& label,
                 const std::vector<StatePoint>& states, double log_end_s) {
  constexpr double kMissedPeriods = 5.0;
  constexpr double kMinGap_s = 1.0;
  // Of an event that is sent once the log says when, not for how long.
  const double period_s = signal.message().period_ms / 1000.0;
  const double gap_s = period_s > 0.0 ? std::max(kMinGap_s, kMissedPeriods * period_s) : 0.0;
  BandRow row{label, {}};
  for (const BandInterval& interval : band_intervals(states, period_s, gap_s, log_end_s)) {
    ChartBand band = signal.band(interval);
    if (band.color.alpha > 0.0) row.bands.push_back(std::move(band));
  }
  return row;
}

std::vector<ChartPoint> thinned(const std::vector<ChartPoint>& points, std::size_t groups) {
  if (points.size() <= 4 * groups) return points;
  std::vector<ChartPoint> thin;
  thin.reserve(2 * groups);
  for (std::size_t group = 0; group < groups; ++group) {
    const auto begin = points.begin() + static_cast<long>(group * points.size() / groups);
    const auto end = points.begin() + static_cast<long>((group + 1) * points.size() / groups);
    auto [low, high] = std::minmax_element(
        begin, end, [](const ChartPoint& a, const ChartPoint& b) { return a.y < b.y; });
    if (high < low) std::swap(low, high);
    thin.push_back(*low);
    if (high != low) thin.push_back(*high);
  }
  return thin;
}

}  // namespace screed
