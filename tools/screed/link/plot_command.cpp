// `screed plot`.
#include "tools/screed/link/plot_command.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <set>

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/log_decoder.h"
#include "host_sim/render/picture/svg_png.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

/// At most so many points a series and pixel: beyond, the extremes of each group of points stand
/// for it, so that no peak is lost.
constexpr size_t kGroupsPerPixel = 1;

std::vector<ChartPoint> thinned(const std::vector<ChartPoint>& points, size_t groups) {
  if (points.size() <= 4 * groups) return points;
  std::vector<ChartPoint> thin;
  for (size_t group = 0; group < groups; ++group) {
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

bool ends_with(const std::string& text, const char* ending) {
  return std::filesystem::path(text).extension() == ending;
}

}  // namespace

Chart plot_chart(const PlotOptions& options, std::ostream& err) {
  std::vector<SignalRef> places;
  std::set<std::string> units;
  for (const std::string& path : options.signals) {
    places.push_back(find_signal(path));
    units.insert(places.back().signal->unit);
  }
  LogDecoder decoder(options.log);
  DecodedFrame frame;
  std::optional<uint64_t> begin_us;
  // By signal, then by robot.
  std::vector<std::map<uint8_t, std::vector<ChartPoint>>> series(places.size());
  std::set<uint8_t> robots;
  while (decoder.next(frame)) {
    if (!begin_us.has_value()) begin_us = frame.time_us;
    const double time_s =
        (static_cast<double>(frame.time_us) - static_cast<double>(*begin_us)) / 1e6;
    if (time_s < options.from_s || time_s > options.to_s.value_or(time_s)) continue;
    if (options.robot.has_value() && *options.robot != frame.node) continue;
    for (size_t i = 0; i < places.size(); ++i) {
      if (places[i].message != frame.message) continue;
      const SignalInfo& signal = *places[i].signal;
      series[i][frame.node].push_back({time_s, signal.value(signal.raw(frame.bits))});
      robots.insert(frame.node);
    }
  }
  if (decoder.statistics().damaged() > 0) {
    err << options.log << ": " << decoder.statistics().text() << "\n";
  }

  Chart chart;
  chart.x_label = "time [s]";
  chart.y_label = units.size() == 1 ? *units.begin() : "";
  chart.from_zero = false;
  chart.width_px = options.width_px;
  chart.height_px = options.height_px;
  chart.title = std::filesystem::path(options.log).filename().string();
  for (size_t i = 0; i < places.size(); ++i) {
    for (const auto& [robot, points] : series[i]) {
      std::string label = std::string(places[i].message->title) + "." + places[i].signal->name;
      if (units.size() > 1 && places[i].signal->unit[0] != '\0') {
        label += std::string(" [") + places[i].signal->unit + "]";
      }
      if (robots.size() > 1) label += ", robot " + std::to_string(robot);
      chart.series.push_back(
          {label, thinned(points, static_cast<size_t>(options.width_px) * kGroupsPerPixel), false});
    }
  }
  if (chart.series.empty()) {
    throw InputError(options.log + ": holds none of these signals in this time; " +
                     decoder.statistics().text());
  }
  return chart;
}

int run_plot(const PlotOptions& options, std::ostream& err) {
  const bool png = ends_with(options.out, ".png");
  if (!png && !ends_with(options.out, ".svg")) {
    throw InputError("--out " + options.out + ": the name ends in .svg or .png");
  }
  const Chart chart = plot_chart(options, err);
  if (png) {
    write_svg_as_png(options.out, chart_svg(chart));
  } else {
    write_chart(options.out, chart);
  }
  return 0;
}

void register_plot_command(CLI::App& root, Program& program) {
  const auto options = std::make_shared<PlotOptions>();
  CLI::App* command = root.add_subcommand("plot", "Plot signals of a radio log over time");
  command->add_option("LOG", options->log, "Log as written by candump -L; -: standard input")
      ->required();
  command
      ->add_option("SIGNALS", options->signals,
                   "Signals to plot, e.g. attitude.pitch (docs/telemetry.md)")
      ->required();
  command->add_option("--out", options->out, "Output picture, .svg or .png")
      ->type_name("FILE")
      ->required();
  add_number(*command, "--robot", options->robot, "Plot one robot only", {1, 15});
  add_number(*command, "--from", options->from_s, "Start, after the log's first message [s]",
             {0.0, 1e9})
      ->capture_default_str();
  add_number(*command, "--to", options->to_s, "End, after the log's first message [s]", {0.0, 1e9});
  add_number(*command, "--width", options->width_px,
             "Width of the SVG [px]; a PNG has twice as many", {320, 4000})
      ->capture_default_str();
  add_number(*command, "--height", options->height_px,
             "Height of the SVG [px]; a PNG has twice as many", {240, 4000})
      ->capture_default_str();
  command->callback([options, &program] {
    program.action = [options] { return run_plot(*options, std::cerr); };
  });
}

}  // namespace screed
