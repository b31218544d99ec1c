// What charts are made of: axes with ticks at round numbers, series of points as lines, dots and
// error bars, and legends that take as many rows as they need.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/render/chart/svg.h"
#include "host_sim/render/picture/map_frame.h"

namespace screed {

/// The values that an axis has to show.
struct ValueRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value);
  /// Makes it at least a little wide: from -1 to 1 when nothing was added. from_zero: it begins at
  /// 0 when no value lies below, and ends at 1 when none lies above either.
  void open(bool from_zero = false);
};

/// One axis: values to pixels, and its ticks. end_px lies above or to the right of begin_px.
struct ChartAxis {
  Ticks ticks;
  double low = 0.0;
  double high = 1.0;
  double begin_px = 0.0;
  double end_px = 1.0;

  double operator()(double value) const {
    return begin_px + (value - low) / (high - low) * (end_px - begin_px);
  }
};

/// An upright axis: round ticks of which the first and the last enclose the range, which grows to
/// them. The range is open.
ChartAxis enclosing_axis(ValueRange range, int about_ticks, double bottom_px, double top_px);
/// A level axis over just this range, with `air` of it on both sides, and the round ticks in it.
ChartAxis tight_axis(const ValueRange& range, double air, double left_px, double right_px);

/// A tick for people: groups of three digits, a real minus sign.
std::string tick_text(double value, int decimals);
/// The width of the widest tick.
double tick_width_px(const ChartAxis& axis);

/// Grid lines and numbers left of them, and the title of the axis, reading upwards at `title_x_px`.
void draw_upright_axis(Svg& svg, const ChartAxis& y, double left_px, double right_px,
                       const std::string& title, double title_x_px);
/// Faint upright lines through the ticks of a level axis.
void draw_tick_lines(Svg& svg, const ChartAxis& x, double top_px, double bottom_px);
/// The base line with marks and numbers, and the title below them. Needs level_axis_height_px().
void draw_level_axis(Svg& svg, const ChartAxis& x, double y_px, const std::string& title);
double level_axis_height_px(const std::string& title);

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
