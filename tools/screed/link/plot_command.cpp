// `screed plot`.
#include "tools/screed/link/plot_command.h"

#include <filesystem>
#include <iostream>
#include <map>
#include <set>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"
#include "host_sim/render/chart/panel_plan.h"
#include "host_sim/render/chart/svg_png.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/link/plot_signals.h"

namespace screed {
namespace {

bool ends_with(const std::string& text, const char* ending) {
  return std::filesystem::path(text).extension() == ending;
}

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
  std::optional<uint64_t> begin_us;
  while (decoder.next(frame)) {
    if (!begin_us.has_value()) begin_us = frame.time_us;
    const double time_s =
        (static_cast<double>(frame.time_us) - static_cast<double>(*begin_us)) / 1e6;
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
  if (decoder.statistics().damaged() > 0) err << options.log << ": " << statistics << "\n";
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
  const bool png = ends_with(options.out, ".png");
  if (!png && !ends_with(options.out, ".svg")) {
    throw InputError("--out " + options.out + ": the name ends in .svg or .png");
  }
  const std::string svg = stacked_chart_svg(plot_chart(options, err));
  if (png) {
    write_svg_as_png(options.out, svg);
  } else {
    write_file(options.out, svg);
  }
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

}  // namespace screed
