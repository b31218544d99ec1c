// Charts of several panels over one shared axis, as SVG: an axis for each unit, states as labelled
// bands. Knows numbers, words and colours, nothing of what they mean. The same chart gives the same
// bytes everywhere.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host_sim/render/chart/chart_parts.h"
#include "host_sim/render/chart/svg.h"

namespace screed {

/// A state that held from begin to end; an empty name is drawn as a band without words.
struct ChartBand {
  double begin;
  double end;
  std::string name;
  Color color;
};

struct BandRow {
  std::string label;             ///< left of the bands
  std::vector<ChartBand> bands;  ///< without any the row says "none"
};

/// Either lines over an axis of their own, or rows of bands.
struct ChartPanel {
  std::string title;  ///< of the upright axis, with the unit; panels of bands have none
  std::vector<ChartSeries> series;
  std::vector<BandRow> rows;
  bool from_zero = false;  ///< the axis begins at 0 when no value lies below
};

struct StackedChart {
  std::string title;
  std::string subtitle;
  std::string x_label;
  std::vector<ChartPanel> panels;
  ValueRange x;        ///< shown at least; empty: what the panels hold
  int width_px = 960;  ///< kMinChartWidth_px..kMaxChartSide_px
  /// kMinChartHeight_px..kMaxChartSide_px, and enough for the panels; none: as much as they need to
  /// be read well.
  std::optional<int> height_px;
};

/// The text of an SVG file. Throws InputError when there is nothing to draw, a number is not
/// finite, or the size is out of range or too small for the panels.
std::string stacked_chart_svg(const StackedChart& chart);

/// Draws panels, axis and titles into a box of a larger picture. Throws as stacked_chart_svg().
void draw_stacked_chart(Svg& svg, const StackedChart& chart, const PixelBox& box);

}  // namespace screed
