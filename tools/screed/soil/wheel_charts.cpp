// Charts of wheels over slip.
#include "tools/screed/soil/wheel_charts.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "host_sim/core/constants.h"
#include "host_sim/soil_validation/soil_measurements.h"
#include "tools/screed/soil/soil_command.h"

namespace screed {
namespace {

/// What a chart shows, of a computed and of a measured wheel.
struct Quantity {
  const char* file;
  const char* title;
  const char* label;
  double scale;  ///< from SI to the label's unit
  double WheelReaction::*computed;
  WheelColumn measured;
  WheelColumn error;
};
constexpr Quantity kQuantities[] = {
    {"sinkage", "Sinkage of a wheel", "sinkage [mm]", 1e3, &WheelReaction::sinkage_m,
     &MeasuredWheel::sinkage_m, &MeasuredWheel::sinkage_error_m},
    {"pull", "Drawbar pull of a wheel", "drawbar pull [N]", 1.0, &WheelReaction::drawbar_pull_n,
     &MeasuredWheel::drawbar_pull_n, &MeasuredWheel::drawbar_pull_error_n},
    {"side_force", "Side force on a wheel", "side force, to the left [N]", 1.0,
     &WheelReaction::side_force_n, &MeasuredWheel::side_force_n,
     &MeasuredWheel::side_force_error_n}};

Chart chart_over_slip(const Quantity& quantity) {
  Chart chart;
  chart.title = quantity.title;
  chart.x_label = "slip [1]";
  chart.y_label = quantity.label;
  return chart;
}

/// Text that a user gave, in the name of a file: letters, digits, + and -, and points inside.
std::string file_part(std::string text) {
  for (char& c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '-' && c != '+' && c != '.')
      c = '_';
  }
  while (!text.empty() && text.back() == '_') text.pop_back();
  return text;
}

/// What the points of a series are, and what their bars: "measured: mean and standard deviation of
/// 3 trials".
std::string measured_label(const std::vector<TrialMean>& means) {
  std::size_t least = 0;
  std::size_t most = 0;
  bool single = false;
  bool stated = false;
  for (const TrialMean& mean : means) {
    if (mean.trials == 1) {
      single = true;
      stated = stated || mean.error > 0.0;
      continue;
    }
    least = most == 0 ? mean.trials : std::min(least, mean.trials);
    most = std::max(most, mean.trials);
  }
  std::string label = "measured";
  if (most > 0) {
    label += ": mean and standard deviation of ";
    if (least < most) label += std::to_string(least) + " to ";
    label += std::to_string(most) + " trials";
  }
  if (stated) label += most > 0 ? "; single: stated error" : ", with the stated error";
  if (single && !stated && most > 0) label += "; and single ones";
  return label;
}

/// Of one slip angle.
struct AngleSeries {
  ChartSeries screed;
  ChartSeries limit;
  ChartSeries measured;
};

/// Nothing when the quantity was not measured there.
std::optional<AngleSeries> series_of(const WheelComparison& comparison, const Quantity& quantity,
                                     const std::vector<WheelTrials>& tests,
                                     const std::string& suffix) {
  ChartSeries screed{"Screed" + suffix, {}, false};
  ChartSeries limit{"limit" + suffix, {}, false};
  limit.dashed = true;
  ChartSeries measured{"", {}, true, false};
  std::vector<TrialMean> means;
  for (const WheelTrials& test : tests) {
    const auto mean = mean_of_trials(comparison.measured, test, quantity.measured, quantity.error);
    if (!mean) continue;
    means.push_back(*mean);
    measured.points.push_back(
        {test.slip, mean->value * quantity.scale, mean->error * quantity.scale});
    const auto add = [&](ChartSeries& series, const std::vector<MeasuredWheel>& rows) {
      const auto computed = mean_of_trials(rows, test, quantity.measured);
      if (computed) series.points.push_back({test.slip, computed->value * quantity.scale});
    };
    add(screed, comparison.screed);
    add(limit, comparison.limit);
  }
  if (means.empty()) return std::nullopt;
  measured.label = measured_label(means) + suffix;
  return AngleSeries{screed, limit, measured};
}

}  // namespace

std::vector<WheelChart> wheel_charts(const WheelSweep& sweep) {
  std::vector<WheelChart> charts;
  for (const Quantity& quantity : kQuantities) {
    if (quantity.computed == &WheelReaction::side_force_n && !sweep.with_side_force) continue;
    Chart chart = chart_over_slip(quantity);
    chart.title += ": " + sweep.subject;
    chart.subtitle = sweep.subtitle;
    for (const WheelCurve& curve : sweep.curves) {
      ChartSeries series{curve.label, {}, curve.markers};
      for (std::size_t i = 0; i < curve.slips.size(); ++i) {
        series.points.push_back(
            {curve.slips[i], curve.reactions[i].*quantity.computed * quantity.scale});
      }
      std::stable_sort(series.points.begin(), series.points.end(),
                       [](const ChartPoint& a, const ChartPoint& b) { return a.x < b.x; });
      chart.series.push_back(series);
    }
    charts.push_back({"soil_" + sweep.prefix + "_" + quantity.file + ".svg", chart});
  }
  return charts;
}

std::vector<WheelChart> measured_charts(const WheelComparison& comparison) {
  // By slip angle: one set of series each.
  std::vector<std::vector<WheelTrials>> angles;
  for (const WheelTrials& test : wheel_trials(comparison.measured)) {
    if (angles.empty() || angles.back()[0].slip_angle_rad != test.slip_angle_rad)
      angles.emplace_back();
    angles.back().push_back(test);
  }
  std::string cases = file_part(comparison.cases);
  if (!cases.empty()) cases += "_";
  std::vector<WheelChart> charts;
  for (const Quantity& quantity : kQuantities) {
    Chart chart = chart_over_slip(quantity);
    chart.title += ", measured and simulated";
    chart.subtitle = comparison.subtitle;
    std::vector<ChartSeries> points;
    for (const std::vector<WheelTrials>& tests : angles) {
      const std::string suffix =
          angles.size() > 1 ? text(", %g deg", tests[0].slip_angle_rad / kDegree) : "";
      const std::optional<AngleSeries> series = series_of(comparison, quantity, tests, suffix);
      if (!series) continue;
      chart.series.insert(chart.series.end(), {series->screed, series->limit});
      points.push_back(series->measured);
    }
    if (points.empty()) continue;
    if (quantity.computed == &WheelReaction::drawbar_pull_n && !comparison.chrono_pull.empty())
      chart.series.push_back({"Chrono", comparison.chrono_pull, false});
    // Measured points last: above all lines.
    if (points.size() == 1) points[0].color = kChartInk;
    chart.series.insert(chart.series.end(), points.begin(), points.end());
    charts.push_back({"soil_measured_" + cases + quantity.file + ".svg", chart});
  }
  return charts;
}

std::vector<WheelChart> schedule_charts(const std::string& subject,
                                        const std::vector<WheelSample>& samples) {
  struct OverTime {
    const char* file;
    const char* title;
    const char* label;
    double scale;
    double WheelSample::*value;
  };
  constexpr OverTime kCharts[] = {
      {"sinkage", "Sinkage of a wheel", "sinkage [mm]", 1e3, &WheelSample::sinkage_m},
      {"pull", "Drawbar pull of a wheel", "drawbar pull [N]", 1.0, &WheelSample::drawbar_pull_n},
      {"side_force", "Side force on a wheel", "side force, to the left [N]", 1.0,
       &WheelSample::side_force_n}};
  std::vector<WheelChart> charts;
  for (const OverTime& one : kCharts) {
    Chart chart;
    chart.title = std::string(one.title) + " on a schedule: " + subject;
    chart.x_label = "time [s]";
    chart.y_label = one.label;
    ChartSeries series{"Screed", {}, false};
    for (const WheelSample& at : samples)
      series.points.push_back({at.time_s, at.*one.value * one.scale});
    chart.series.push_back(series);
    charts.push_back({std::string("soil_schedule_") + one.file + ".svg", chart});
  }
  return charts;
}

WheelChart transient_chart(const std::string& subject,
                           const std::vector<TransientComparison>& transients) {
  Chart chart;
  chart.title = "Sinkage by slip, measured and simulated: " + subject;
  chart.x_label = "slip path [mm]";
  chart.y_label = "sinkage beyond that without slip [mm]";
  for (const TransientComparison& one : transients) {
    const std::string rim = text(", rim %g mm/s", one.measured.rim_m_per_s * kMilli);
    const double last = std::abs(one.measured.places.back().slip_path_m);
    ChartSeries series{"Screed" + rim, {}, false};
    for (const WheelSample& at : one.screed) {
      if (std::abs(at.slip_path_m) > last) break;
      series.points.push_back(
          {at.slip_path_m * kMilli, (at.sinkage_m - one.screed.front().sinkage_m) * kMilli});
    }
    chart.series.push_back(series);
    ChartSeries points{"measured" + rim, {}, true, false};
    for (const MeasuredTransient::Place& place : one.measured.places)
      points.points.push_back(
          {place.slip_path_m * kMilli, place.extra_sinkage_m * kMilli, place.error_m * kMilli});
    chart.series.push_back(points);
  }
  return {"soil_transient.svg", chart};
}

}  // namespace screed
