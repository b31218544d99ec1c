// Series of points: their lines, dots and error bars over two axes, and legends that take as many
// rows as they need.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/render/chart/chart_axis.h"
#include "host_sim/render/chart/svg.h"

namespace screed {

struct ChartPoint {
  double x;
  double y;
  double error = 0.0;  ///< the error bar reaches this far up and down; 0: none
};

struct ChartSeries {
  std::string label;  ///< in the legend; empty: not there
  std::vector<ChartPoint> points;
  bool markers = true;  ///< a dot at every point
  /// A line through the points. Without it dots alone: small ones below error bars, as measurements
  /// are shown; and without markers, as in a scatter plot of thousands, half transparent ones.
  bool joined = true;
  bool dashed = false;           ///< a line that shows one below it
  double jump = 0.0;             ///< the line breaks where y changes by more; 0: never
  std::optional<Color> color{};  ///< none: line_color() of its place among the series
};

/// In a chart of these series.
Color series_color(const std::vector<ChartSeries>& series, std::size_t index);

/// Adds all points, with their error bars, to the ranges.
void add_to_ranges(const std::vector<ChartSeries>& series, ValueRange& x, ValueRange& y);

/// Throws InputError that names `chart` and the series when a number is not finite. Returns whether
/// there is any point.
bool check_series(const std::string& chart, const std::vector<ChartSeries>& series);

void draw_error_bar(Svg& svg, double x_px, const ChartAxis& y, const ChartPoint& point,
                    Color color);
/// Points, line and error bars.
void draw_series(Svg& svg, const ChartAxis& x, const ChartAxis& y, const ChartSeries& series,
                 Color color);

struct LegendEntry {
  std::string label;
  Color color;
};

/// Where the entries of a legend stand: from the left, in rows of `width_px`.
struct LegendPlace {
  std::size_t row;
  double left_px;
};
inline constexpr double kLegendRow_px = 20.0;
std::vector<LegendPlace> legend_places(const std::vector<LegendEntry>& entries, double width_px);
/// 0 without entries.
double legend_height_px(const std::vector<LegendEntry>& entries, double width_px);
/// Draws it in the box from (left, top) down.
void draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, double left_px, double top_px,
                 double width_px);
/// Those of the series that have a label, with their colours as lines.
std::vector<LegendEntry> legend_of(const std::vector<ChartSeries>& series);

}  // namespace screed
