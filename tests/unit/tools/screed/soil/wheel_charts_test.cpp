// Charts of wheels: files, series and their points, and what legends say about the bars.
#include "tools/screed/soil/wheel_charts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/host_sim/soil_validation/measured_row.h"

namespace screed {
namespace {

MeasuredWheel row(double slip, double slip_angle_rad, double pull_n) {
  MeasuredWheel out = measured_row(slip, slip_angle_rad);
  out.drawbar_pull_n = pull_n;
  return out;
}

/// Screed gives a newton more than was measured, the limit two.
WheelComparison comparison_of(const std::vector<MeasuredWheel>& measured) {
  WheelComparison out;
  out.cases = "a/b c_";
  out.measured = out.screed = out.limit = measured;
  for (MeasuredWheel& one : out.screed) one.drawbar_pull_n = *one.drawbar_pull_n + 1.0;
  for (MeasuredWheel& one : out.limit) one.drawbar_pull_n = *one.drawbar_pull_n + 2.0;
  return out;
}

std::vector<std::string> labels_of(const Chart& chart) {
  std::vector<std::string> labels;
  for (const ChartSeries& series : chart.series) labels.push_back(series.label);
  return labels;
}

using Names = std::vector<std::string>;

void expect_points(const ChartSeries& series, const std::vector<ChartPoint>& expected) {
  SCOPED_TRACE(series.label);
  ASSERT_EQ(series.points.size(), expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    EXPECT_DOUBLE_EQ(series.points[i].x, expected[i].x) << i;
    EXPECT_DOUBLE_EQ(series.points[i].y, expected[i].y) << i;
    EXPECT_DOUBLE_EQ(series.points[i].error, expected[i].error) << i;
  }
}

TEST(MeasuredCharts, TrialsAreOnePointWithABarAmongLines) {
  const WheelComparison comparison = comparison_of(
      {row(0.4, 0.0, 9.0), row(0.1, 0.0, 2.0), row(0.1, 0.0, 4.0), row(0.1, 0.0, 6.0)});
  const std::vector<WheelChart> charts = measured_charts(comparison);
  ASSERT_EQ(charts.size(), 1U) << "nothing else was measured";
  EXPECT_EQ(charts[0].file, "soil_measured_a_b_c_pull.svg");
  const std::vector<ChartSeries>& series = charts[0].chart.series;
  ASSERT_EQ(labels_of(charts[0].chart),
            (Names{"Screed", "limit",
                   "measured: mean and standard deviation of 3 trials; and single ones"}));
  expect_points(series[0], {{0.1, 5.0}, {0.4, 10.0}});
  expect_points(series[1], {{0.1, 6.0}, {0.4, 11.0}});
  expect_points(series[2], {{0.1, 4.0, 2.0}, {0.4, 9.0}});
  EXPECT_TRUE(series[0].joined);
  EXPECT_TRUE(series[1].joined);
  EXPECT_FALSE(series[2].joined);
  EXPECT_TRUE(series[2].markers);
  ASSERT_TRUE(series[2].color);
  EXPECT_EQ(series[2].color->red, kChartInk.red);
  EXPECT_EQ(series[2].color->green, kChartInk.green);
}

TEST(MeasuredCharts, LegendsSayWhatBarsAre) {
  std::vector<MeasuredWheel> rows = {row(0.1, 0.0, 2.0), row(0.4, 0.0, 3.0)};
  const auto label = [&] {
    return labels_of(measured_charts(comparison_of(rows))[0].chart).back();
  };
  EXPECT_EQ(label(), "measured");
  rows[1].drawbar_pull_error_n = 0.5;
  EXPECT_EQ(label(), "measured, with the stated error");
  rows.push_back(row(0.1, 0.0, 2.5));
  EXPECT_EQ(label(), "measured: mean and standard deviation of 2 trials; single: stated error");
  rows.pop_back();
  rows.insert(rows.end(), {row(0.1, 0.0, 2.5), row(0.4, 0.0, 3.5), row(0.4, 0.0, 3.0)});
  EXPECT_EQ(label(), "measured: mean and standard deviation of 2 to 3 trials");
}

TEST(MeasuredCharts, EachSlipAngleHasItsOwnLines) {
  constexpr double kDegree = 3.14159265358979323846 / 180.0;
  WheelComparison comparison =
      comparison_of({row(0.1, 0.0, 2.0), row(0.1, -15.0 * kDegree, 3.0), row(0.4, 0.0, 4.0)});
  comparison.measured[1].sinkage_m = 0.012;
  comparison.measured[1].sinkage_error_m = 0.0005;
  comparison.measured[1].side_force_n = 7.0;
  comparison.screed[1].sinkage_m = 0.013;
  comparison.screed[0].sinkage_m = 0.5;
  comparison.chrono_pull = {{0.1, 5.0}};
  comparison.cases = "";
  const std::vector<WheelChart> charts = measured_charts(comparison);
  ASSERT_EQ(charts.size(), 3U);
  EXPECT_EQ(charts[0].file, "soil_measured_sinkage.svg");
  EXPECT_EQ(charts[1].file, "soil_measured_pull.svg");
  EXPECT_EQ(charts[2].file, "soil_measured_side_force.svg");
  EXPECT_EQ(labels_of(charts[1].chart),
            (Names{"Screed, -15 deg", "limit, -15 deg", "Screed, 0 deg", "limit, 0 deg", "Chrono",
                   "measured, -15 deg", "measured, 0 deg"}))
      << "points above all lines";
  expect_points(charts[1].chart.series[2], {{0.1, 3.0}, {0.4, 5.0}});
  expect_points(charts[1].chart.series[4], {{0.1, 5.0}});
  EXPECT_FALSE(charts[1].chart.series[5].color) << "black would be both angles'";
  // In millimetres; only where it was measured.
  EXPECT_EQ(labels_of(charts[0].chart), (Names{"Screed, -15 deg", "limit, -15 deg",
                                               "measured, with the stated error, -15 deg"}));
  expect_points(charts[0].chart.series[0], {{0.1, 13.0}});
  expect_points(charts[0].chart.series[2], {{0.1, 12.0, 0.5}});
  EXPECT_EQ(charts[2].chart.series.size(), 3U);
}

TEST(WheelCharts, CurvesAreJoinedInTheOrderOfSlips) {
  WheelReaction at_high;
  at_high.sinkage_m = 0.002;
  at_high.drawbar_pull_n = 3.0;
  at_high.side_force_n = -4.0;
  WheelReaction at_low;
  at_low.drawbar_pull_n = 1.0;
  WheelSweep sweep{
      "limit", "sand", "a wheel", {{"limit, 30 deg", false, {0.5, -0.5}, {at_high, at_low}}}, true};
  const std::vector<WheelChart> charts = wheel_charts(sweep);
  ASSERT_EQ(charts.size(), 3U);
  EXPECT_EQ(charts[0].file, "soil_limit_sinkage.svg");
  EXPECT_EQ(charts[1].file, "soil_limit_pull.svg");
  EXPECT_EQ(charts[2].file, "soil_limit_side_force.svg");
  EXPECT_EQ(charts[1].chart.title, "Drawbar pull of a wheel: sand");
  EXPECT_EQ(charts[1].chart.subtitle, "a wheel");
  EXPECT_EQ(labels_of(charts[1].chart), (Names{"limit, 30 deg"}));
  expect_points(charts[0].chart.series[0], {{-0.5, 0.0}, {0.5, 2.0}});
  expect_points(charts[1].chart.series[0], {{-0.5, 1.0}, {0.5, 3.0}});
  expect_points(charts[2].chart.series[0], {{-0.5, 0.0}, {0.5, -4.0}});
  sweep.with_side_force = false;
  EXPECT_EQ(wheel_charts(sweep).size(), 2U);
}

}  // namespace
}  // namespace screed
