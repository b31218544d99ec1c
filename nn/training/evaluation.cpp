// Scores and charts.
#include "nn/training/evaluation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "host_sim/core/atomic_file.h"
#include "host_sim/render/chart/line_chart.h"
#include "host_sim/render/chart/svg.h"
#include "nn/training/predict.h"

namespace screed::nn {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFramesDrawn = 4000;       ///< of a time series
constexpr std::size_t kMaxPoints = 1000;         ///< of a line
constexpr std::size_t kMaxScatterPoints = 3000;  ///< of a scatter plot

struct OutputSeries {
  std::string output;
  std::vector<double> real;
  std::vector<double> predicted;  ///< by the integers
  std::vector<double> in_float;   ///< empty: the model has no floating point
};

std::string learned_name(const ModelChannel& channel) {
  return channel.baseline.empty() ? channel.feature : channel.feature + "-" + channel.baseline;
}

/// All outputs of all networks over a table. `at_network`: called before each network; may be
/// empty.
std::vector<OutputSeries> series_of(const Model& model, const FeatureTable& table,
                                    const std::function<void()>& at_network) {
  std::vector<OutputSeries> result;
  for (const ModelNetwork& network : model.networks) {
    if (at_network) at_network();
    std::vector<std::string> inputs;
    std::vector<std::string> outputs;
    for (const ModelChannel& channel : network.inputs) inputs.push_back(channel.feature);
    for (const ModelChannel& channel : network.outputs) outputs.push_back(learned_name(channel));
    const Examples examples = examples_of({&table}, inputs, outputs);
    const std::vector<double> integers = predict(network.network, examples);
    const std::vector<double> floats =
        network.trained.empty() ? std::vector<double>{} : predict(network.trained, examples);
    const auto every = [&](const auto& values, std::size_t first) {
      std::vector<double> column;
      for (std::size_t i = first; i < values.size(); i += outputs.size()) {
        column.push_back(static_cast<double>(values[i]));
      }
      return column;
    };
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      result.push_back({outputs[i], every(examples.out, i), every(integers, i), every(floats, i)});
    }
  }
  return result;
}

const OutputSeries* find(const std::vector<OutputSeries>& series, const char* output) {
  const auto found = std::find_if(series.begin(), series.end(),
                                  [&](const OutputSeries& one) { return one.output == output; });
  return found == series.end() ? nullptr : &*found;
}

void add_ranks(const TestTable& test, const std::vector<OutputSeries>& series,
               Evaluation& evaluation) {
  const FeatureTable& table = test.table;
  const OutputSeries* turn = find(series, "delta_theta");
  if (turn != nullptr && table.has("v_left") && table.has("v_right")) {
    std::vector<double> difference(table.rows());
    for (std::size_t row = 0; row < table.rows(); ++row) {
      difference[row] = table.column("v_left")[row] - table.column("v_right")[row];
    }
    evaluation.ranks.push_back({"v_left - v_right, delta_theta", test.label, test.form,
                                spearman(difference, turn->real),
                                spearman(difference, turn->predicted)});
  }
  const OutputSeries* speed = find(series, "v");
  if (speed != nullptr && table.has("pitch")) {
    const std::vector<double>& pitch = table.column("pitch");
    evaluation.ranks.push_back({"v, pitch", test.label, test.form, spearman(speed->real, pitch),
                                spearman(speed->predicted, pitch)});
  }
}

std::string file_name(const TestTable& test, const std::string& output, const char* kind) {
  std::string name = output + "_" + test.label + "_" + test.form + "_" + kind;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

fs::path write_both(const fs::path& folder, const std::string& name, const Chart& chart) {
  fs::path svg = folder / (name + ".svg");
  const std::string text = chart_svg(chart);
  write_file(svg, text);
  write_svg_as_png(folder / (name + ".png"), text);
  return svg;
}

Chart time_series(const TestTable& test, const OutputSeries& series, const std::string& subtitle) {
  Chart chart;
  chart.title = series.output + " on test " + test.label + ", " + test.form;
  chart.subtitle = subtitle;
  chart.x_label = "frame of the session";
  chart.y_label = series.output + " [normalised]";
  chart.from_zero = false;
  chart.width_px = 1200;
  const std::size_t rows = std::min(series.real.size(), kFramesDrawn);
  const std::size_t every = std::max<std::size_t>(1, rows / kMaxPoints);
  ChartSeries real{"recorded", {}, false};
  ChartSeries predicted{"network", {}, false};
  // From the middle of the session, where no smoothing is cut short.
  const std::size_t first = (series.real.size() - rows) / 2;
  for (std::size_t i = first; i < first + rows; i += every) {
    const auto frame = static_cast<double>(test.table.frames[i]);
    real.points.push_back({frame, series.real[i]});
    predicted.points.push_back({frame, series.predicted[i]});
  }
  chart.series = {real, predicted};
  return chart;
}

Chart regression(const TestTable& test, const OutputSeries& series, const std::string& subtitle) {
  Chart chart;
  chart.title = series.output + " on test " + test.label + ", " + test.form;
  chart.subtitle = subtitle;
  chart.x_label = "recorded [normalised]";
  chart.y_label = "network [normalised]";
  chart.from_zero = false;
  chart.width_px = 620;
  chart.height_px = 620;
  ChartSeries dots{"a frame", {}, false, false};
  const std::size_t every = std::max<std::size_t>(1, series.real.size() / kMaxScatterPoints);
  for (std::size_t i = 0; i < series.real.size(); i += every) {
    dots.points.push_back({series.real[i], series.predicted[i]});
  }
  // The line of least squares, from end to end.
  double mean_x = 0.0;
  double mean_y = 0.0;
  const auto count = static_cast<double>(series.real.size());
  for (std::size_t i = 0; i < series.real.size(); ++i) {
    mean_x += series.real[i] / count;
    mean_y += series.predicted[i] / count;
  }
  double xy = 0.0;
  double xx = 0.0;
  for (std::size_t i = 0; i < series.real.size(); ++i) {
    xy += (series.real[i] - mean_x) * (series.predicted[i] - mean_y);
    xx += (series.real[i] - mean_x) * (series.real[i] - mean_x);
  }
  const double slope = xx > 0.0 ? xy / xx : 0.0;
  const auto [low, high] = std::minmax_element(series.real.begin(), series.real.end());
  ChartSeries fit{"regression", {}, false};
  ChartSeries same{"equal", {}, false};
  for (const double x : {*low, *high}) {
    fit.points.push_back({x, mean_y + slope * (x - mean_x)});
    same.points.push_back({x, x});
  }
  chart.series = {dots, fit, same};
  return chart;
}

}  // namespace

Evaluation evaluate(const Model& model, const std::vector<TestTable>& tests,
                    const TaskProgress& progress) {
  Evaluation evaluation;
  std::size_t done = 0;
  const auto report = [&] {
    report_progress(progress, "evaluating", done++, tests.size() * model.networks.size());
  };
  for (const TestTable& test : tests) {
    const std::vector<OutputSeries> all = series_of(model, test.table, report);
    for (const OutputSeries& series : all) {
      Score score{series.output, test.label, test.form, series.real.size(), 0.0, 0.0, 0.0, 0.0};
      score.mse = mean_squared_error(series.real, series.predicted);
      score.r2 = squared_correlation(series.real, series.predicted);
      score.explained = explained_variance(series.real, series.predicted);
      for (std::size_t i = 0; i < series.in_float.size(); ++i) {
        score.quantisation =
            std::max(score.quantisation, std::abs(series.in_float[i] - series.predicted[i]));
      }
      evaluation.scores.push_back(score);
    }
    add_ranks(test, all, evaluation);
  }
  return evaluation;
}

std::vector<fs::path> draw_evaluation(const Model& model, const std::vector<TestTable>& tests,
                                      const fs::path& folder, const TaskProgress& progress) {
  constexpr char kTask[] = "drawing charts";
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < tests.size(); ++i) {
    const TestTable& test = tests[i];
    report_progress(progress, kTask, i, tests.size());
    const std::vector<OutputSeries> all = series_of(model, test.table, {});
    for (std::size_t output = 0; output < all.size(); ++output) {
      const OutputSeries& series = all[output];
      report_progress(progress, kTask, i * all.size() + output, tests.size() * all.size());
      char subtitle[120];
      std::snprintf(subtitle, sizeof subtitle, "model %s, MSE %.4f, R² %.4f", model.name.c_str(),
                    mean_squared_error(series.real, series.predicted),
                    squared_correlation(series.real, series.predicted));
      files.push_back(write_both(folder, file_name(test, series.output, "series"),
                                 time_series(test, series, subtitle)));
      files.push_back(write_both(folder, file_name(test, series.output, "regression"),
                                 regression(test, series, subtitle)));
    }
  }
  return files;
}

std::vector<fs::path> draw_losses(const TrainingConfiguration& configuration,
                                  const std::vector<TrainedNetwork>& networks,
                                  const fs::path& folder) {
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < networks.size(); ++i) {
    const std::string name = configuration.networks[i].name();
    Chart chart;
    chart.title = configuration.name + ", " + name;
    chart.subtitle = "epoch " + std::to_string(networks[i].kept_epoch) + " is kept";
    chart.x_label = "epoch";
    chart.y_label = "mean squared error [normalised]";
    ChartSeries training{"training", {}, false};
    ChartSeries choice{"choice", {}, false};
    const std::size_t every = std::max<std::size_t>(1, networks[i].losses.size() / kMaxPoints);
    for (std::size_t epoch = 0; epoch < networks[i].losses.size(); epoch += every) {
      const auto x = static_cast<double>(epoch + 1);
      training.points.push_back({x, networks[i].losses[epoch].training});
      choice.points.push_back({x, networks[i].losses[epoch].choice});
    }
    chart.series = {training, choice};
    files.push_back(write_both(folder, "loss_" + name, chart));
  }
  return files;
}

}  // namespace screed::nn
