// The figures of thesis 4.2.
#include "host_sim/grid/grid_figures.h"

#include <algorithm>
#include <cstdio>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

std::string short_text(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

GridFigure named(const char* name, const char* title) {
  GridFigure figure;
  figure.name = name;
  figure.title = title;
  return figure;
}

GridFigure constant_probabilities(const GridConfig& base) {
  GridFigure figure = named("4.2", "Algorithm 1: constant probabilities");
  figure.x_label = "probability of picking up and of depositing";
  for (const double p : {0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0}) {
    GridConfig config = base;
    config.algorithm = GridAlgorithm::kProbabilistic;
    config.p_pick_up = p;
    config.p_deposit = p;
    figure.points.push_back({"p = " + short_text(p), p, config});
  }
  return figure;
}

GridFigure response_thresholds(const GridConfig& base) {
  GridFigure figure = named("4.3", "Algorithm 1: response thresholds");
  figure.x_label = "k of the response curves";
  for (int k = 2; k <= 12; ++k) {
    GridConfig config = base;
    config.algorithm = GridAlgorithm::kThreshold;
    config.k = k;
    figure.points.push_back({"k = " + std::to_string(k), static_cast<double>(k), config});
  }
  return figure;
}

GridFigure memetic(const GridConfig& base, bool units) {
  GridFigure figure =
      named(units ? "4.4" : "4.5", units ? "Units moved, probabilistic and memetic algorithms"
                                         : "Cycles, probabilistic and memetic algorithms");
  figure.shows_units = units;
  figure.kind = ChartKind::kBars;
  figure.results_name = "4.4-4.5";
  const std::pair<const char*, GridAlgorithm> rows[] = {
      {"probabilistic, p = 0.3", GridAlgorithm::kProbabilistic},
      {"memetic, variant 1", GridAlgorithm::kMemetic1},
      {"memetic, variant 2", GridAlgorithm::kMemetic2}};
  for (const auto& [label, algorithm] : rows) {
    GridConfig config = base;
    config.algorithm = algorithm;
    config.p_pick_up = 0.3;
    config.p_deposit = 0.3;
    figure.points.push_back({label, static_cast<double>(figure.points.size()), config});
    figure.categories.emplace_back(label);
  }
  return figure;
}

GridFigure better(const GridConfig& base, bool units) {
  GridFigure figure =
      named(units ? "better-units" : "better", units ? "Units moved: Algorithm 1 and better ones"
                                                     : "Cycles: Algorithm 1 and better ones");
  figure.shows_units = units;
  figure.kind = ChartKind::kBars;
  figure.x_label = "mean height [units]";
  figure.series = {"Algorithm 1, p = 0.3", "patient", "forager"};
  figure.results_name = "better";
  int category = 0;
  for (const double mean : {5.97, 6.02, 6.25, 6.5, 8.5}) {
    for (const GridAlgorithm algorithm :
         {GridAlgorithm::kProbabilistic, GridAlgorithm::kPatient, GridAlgorithm::kForager}) {
      GridConfig config = base;
      config.algorithm = algorithm;
      config.noise.mean = mean;
      config.p_pick_up = 0.3;
      config.p_deposit = 0.3;
      figure.points.push_back({std::string(name_of(algorithm)) + ", mean " + short_text(mean),
                               static_cast<double>(category), config});
    }
    figure.categories.push_back(short_text(mean));
    ++category;
  }
  return figure;
}

Summary summary_of(const std::vector<GridResult>& runs, double (*value)(const GridResult&)) {
  std::vector<double> values;
  values.reserve(runs.size());
  for (const GridResult& run : runs) values.push_back(value(run));
  return summarise(values);
}

}  // namespace

const std::vector<std::string>& grid_figure_names() {
  static const std::vector<std::string> names = {"4.2", "4.3",    "4.4",
                                                 "4.5", "better", "better-units"};
  return names;
}

GridFigure grid_figure(const std::string& name, const GridConfig& base) {
  GridFigure figure;
  if (name == "4.2") {
    figure = constant_probabilities(base);
  } else if (name == "4.3") {
    figure = response_thresholds(base);
  } else if (name == "4.4" || name == "4.5") {
    figure = memetic(base, name == "4.4");
  } else if (name == "better" || name == "better-units") {
    figure = better(base, name == "better-units");
  } else {
    std::string all;
    for (const std::string& one : grid_figure_names()) all += (all.empty() ? "" : ", ") + one;
    throw InputError("grid: figure = " + name + "; allowed is " + all);
  }
  if (figure.series.empty()) figure.series = {""};
  if (figure.results_name.empty()) figure.results_name = figure.name;
  return figure;
}

Summary cycles_of(const std::vector<GridResult>& runs) {
  return summary_of(runs, [](const GridResult& r) { return static_cast<double>(r.cycles); });
}

Summary units_of(const std::vector<GridResult>& runs) {
  return summary_of(runs, [](const GridResult& r) { return static_cast<double>(r.units); });
}

size_t failures_of(const std::vector<GridResult>& runs) {
  return static_cast<size_t>(
      std::count_if(runs.begin(), runs.end(), [](const GridResult& r) { return !r.level; }));
}

FigureFiles write_figure(const std::filesystem::path& folder, const GridFigure& figure,
                         const std::vector<std::vector<GridResult>>& results) {
  std::string csv =
      "point,runs,failures,cycles_mean,cycles_standard_error,units_mean,units_standard_error,"
      "least_units_mean,distance_mean\n";
  Chart chart;
  chart.kind = figure.kind;
  chart.title = figure.title;
  chart.x_label = figure.x_label;
  chart.y_label = figure.shows_units ? "units moved" : "cycles until level";
  chart.categories = figure.categories;
  chart.value_labels = figure.kind == ChartKind::kBars;
  if (figure.series.size() > 1) chart.width_px = 960;
  for (const std::string& label : figure.series) chart.series.push_back({label, {}, true});
  size_t runs = 0;
  for (size_t i = 0; i < figure.points.size(); ++i) {
    const SweepPoint& point = figure.points[i];
    const Summary cycles = cycles_of(results[i]);
    const Summary units = units_of(results[i]);
    const Summary minimum = summary_of(
        results[i], [](const GridResult& r) { return static_cast<double>(r.min_units); });
    const Summary distance =
        summary_of(results[i], [](const GridResult& r) { return r.distance(); });
    char line[300];
    std::snprintf(line, sizeof line, "\"%s\",%zu,%zu,%.1f,%.1f,%.1f,%.1f,%.1f,%.1f\n",
                  point.label.c_str(), results[i].size(), failures_of(results[i]), cycles.mean,
                  cycles.standard_error, units.mean, units.standard_error, minimum.mean,
                  distance.mean);
    csv += line;
    const Summary& shown = figure.shows_units ? units : cycles;
    chart.series[i % chart.series.size()].points.push_back(
        {point.x, shown.mean, shown.confidence()});
    runs = results[i].size();
  }
  const GridConfig& config = figure.points.front().config;
  chart.subtitle = std::to_string(config.noise.width) + "x" + std::to_string(config.noise.height) +
                   " cells, " + std::to_string(config.agents) + " agents, " + std::to_string(runs) +
                   " runs a point; bars: 95 % confidence of the mean";
  FigureFiles files{folder / ("figure-" + figure.name + ".csv"),
                    folder / ("figure-" + figure.name + ".svg")};
  write_file(files.csv, csv);
  write_chart(files.svg, chart);
  return files;
}

}  // namespace screed
