// Axes of charts: from values to pixels, ticks at round numbers, and the ink of both.
#pragma once

#include <limits>
#include <string>

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

}  // namespace screed
