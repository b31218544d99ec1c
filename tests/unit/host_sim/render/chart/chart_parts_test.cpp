// Points, lines and error bars of a chart: which shapes stand where.
#include "host_sim/render/chart/chart_parts.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "host_sim/render/chart/line_chart.h"

namespace screed {
namespace {

struct Line {
  Pixel from;
  Pixel to;
};

/// Lines of this colour, in their order.
std::vector<Line> lines_of(const std::string& svg, const std::string& color) {
  std::vector<Line> lines;
  for (std::size_t at = svg.find("<line "); at != std::string::npos;
       at = svg.find("<line ", at + 1)) {
    const std::string element = svg.substr(at, svg.find("/>", at) - at);
    if (element.find(color) == std::string::npos) continue;
    Line line{};
    EXPECT_EQ(std::sscanf(element.c_str(), "<line x1=\"%lf\" y1=\"%lf\" x2=\"%lf\" y2=\"%lf\"",
                          &line.from.x, &line.from.y, &line.to.x, &line.to.y),
              4)
        << element;
    lines.push_back(line);
  }
  return lines;
}

int count(const std::string& svg, const std::string& words) {
  int found = 0;
  for (std::size_t at = svg.find(words); at != std::string::npos; at = svg.find(words, at + 1))
    ++found;
  return found;
}

/// Two points, one with an error bar, in red; the axes hold their pixels.
struct Drawn {
  std::string svg;
  ChartAxis x;
  ChartAxis y;
};

Drawn drawn(ChartSeries series) {
  series.points = {{1.0, 2.0, 0.5}, {3.0, 4.0}};
  Drawn out;
  out.x = tight_axis({1.0, 3.0}, 0.0, 100.0, 300.0);
  out.y = enclosing_axis({0.0, 5.0}, 5, 400.0, 100.0);
  Svg svg(400, 500);
  draw_series(svg, out.x, out.y, series, {1.0, 0.0, 0.0});
  out.svg = svg.finish();
  return out;
}

void expect_one_error_bar(const Drawn& chart) {
  const std::vector<Line> bar = lines_of(chart.svg, "#ff0000");
  ASSERT_EQ(bar.size(), 3U) << "the bar and its two ends; none at the point without an error";
  const double top = chart.y(2.5);
  const double bottom = chart.y(1.5);
  EXPECT_NEAR(bar[0].from.x, chart.x(1.0), 0.01);
  EXPECT_NEAR(bar[0].to.x, chart.x(1.0), 0.01);
  EXPECT_NEAR(bar[0].from.y, top, 0.01);
  EXPECT_NEAR(bar[0].to.y, bottom, 0.01);
  for (const Line* end : {&bar[1], &bar[2]}) {
    EXPECT_NEAR(0.5 * (end->from.x + end->to.x), chart.x(1.0), 0.01);
    EXPECT_EQ(end->from.y, end->to.y);
  }
  EXPECT_NEAR(bar[1].from.y, top, 0.01);
  EXPECT_NEAR(bar[2].from.y, bottom, 0.01);
}

TEST(ChartSeries, PointsThatAreNotJoinedHaveDotsAndErrorBarsAndNoLine) {
  const Drawn chart = drawn({"measured", {}, true, false});
  expect_one_error_bar(chart);
  EXPECT_EQ(count(chart.svg, "<polyline"), 0);
  EXPECT_EQ(count(chart.svg, "<circle"), 2);
  // An error that is hardly above nothing still shows.
  const std::vector<Line> bar = lines_of(chart.svg, "#ff0000");
  ASSERT_EQ(bar.size(), 3U);
  double radius = 0.0;
  ASSERT_EQ(std::sscanf(chart.svg.c_str() + chart.svg.find(" r=\""), " r=\"%lf\"", &radius), 1);
  EXPECT_GT(bar[1].to.x - bar[1].from.x, 2.0 * radius);
  EXPECT_GT(chart.svg.find("<line "), chart.svg.find("<circle")) << "bars above dots";
}

TEST(ChartSeries, ALineHasErrorBars) {
  const Drawn chart = drawn({"line", {}, true});
  expect_one_error_bar(chart);
  EXPECT_EQ(count(chart.svg, "<polyline"), 1);
  EXPECT_EQ(count(chart.svg, "<circle"), 2);
}

TEST(ChartSeries, AScatterPlotHasHalfTransparentDots) {
  const Drawn chart = drawn({"frames", {}, false, false});
  EXPECT_EQ(count(chart.svg, "<polyline"), 0);
  EXPECT_EQ(count(chart.svg, "opacity"), 2);
  EXPECT_EQ(count(drawn({"measured", {}, true, false}).svg, "opacity"), 0);
}

TEST(ChartSeries, TheAxisHoldsTheErrorBars) {
  ValueRange x;
  ValueRange y;
  add_to_ranges({{"measured", {{1.0, 2.0, 0.5}, {3.0, 2.1, 4.0}}, true, false}}, x, y);
  EXPECT_EQ(x.low, 1.0);
  EXPECT_EQ(x.high, 3.0);
  EXPECT_DOUBLE_EQ(y.low, -1.9);
  EXPECT_DOUBLE_EQ(y.high, 6.1);
}

TEST(TickText, HasTheDigitsOfItsStepAndNoNegativeZero) {
  EXPECT_EQ(tick_text(-0.0004, 2), "0.00");
  EXPECT_EQ(tick_text(-0.0, 0), "0");
  EXPECT_EQ(tick_text(-12345.6, 1), "\u221212\u2009345.6");
  EXPECT_EQ(tick_text(-123.0, 0), "\u2212123");
  const ChartAxis axis = enclosing_axis({-0.0003, 0.0004}, 5, 100.0, 0.0);
  std::string texts;
  for (const double tick : axis.ticks.values) texts += tick_text(tick, axis.ticks.decimals) + " ";
  EXPECT_EQ(texts, "\u22120.0004 \u22120.0002 0.0000 0.0002 0.0004 ");
}

}  // namespace
}  // namespace screed
