// Axes, series, legends.
#include "host_sim/render/chart/chart_parts.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr double kTickSize_px = 12.0;
constexpr double kTitleSize_px = 13.0;

}  // namespace

void ValueRange::add(double value) {
  low = std::min(low, value);
  high = std::max(high, value);
}

void ValueRange::open(bool from_zero) {
  if (from_zero && low >= 0.0) {
    low = 0.0;
    if (high <= 0.0) high = 1.0;
  }
  if (low < high) return;
  if (low > high) {
    low = high = 0.0;
  }
  const double margin = low == 0.0 ? 1.0 : std::fabs(low) * 0.1;
  low -= margin;
  high += margin;
}

ChartAxis enclosing_axis(ValueRange range, int about_ticks, double bottom_px, double top_px) {
  ChartAxis axis;
  axis.ticks = round_ticks(range.low, range.high, std::max(2, about_ticks));
  constexpr double kSlack = 1e-9;  // of a step
  const double first = std::floor(range.low / axis.ticks.step + kSlack);
  const double last = std::ceil(range.high / axis.ticks.step - kSlack);
  axis.ticks.values.clear();
  for (int i = 0; first + i <= last; ++i)
    axis.ticks.values.push_back((first + i) * axis.ticks.step);
  axis.low = axis.ticks.values.front();
  axis.high = axis.ticks.values.back();
  axis.begin_px = bottom_px;
  axis.end_px = top_px;
  return axis;
}

ChartAxis tight_axis(const ValueRange& range, double air, double left_px, double right_px) {
  constexpr double kTickDistance_px = 70.0;
  ChartAxis axis;
  axis.ticks = round_ticks(range.low, range.high,
                           std::max(2, static_cast<int>((right_px - left_px) / kTickDistance_px)));
  const double margin = air * (range.high - range.low);
  axis.low = range.low - margin;
  axis.high = range.high + margin;
  std::erase_if(axis.ticks.values,
                [&axis](double tick) { return tick < axis.low || tick > axis.high; });
  axis.begin_px = left_px;
  axis.end_px = right_px;
  return axis;
}

std::string tick_text(double value, int decimals) {
  std::string grouped = number_text(value, decimals);
  const size_t first = std::min(grouped.find_first_of("0123456789"), grouped.size());
  const size_t point = std::min(grouped.find('.'), grouped.size());
  for (size_t at = point; at > first + 3; at -= 3) grouped.insert(at - 3, "\u2009");
  return grouped;
}

double tick_width_px(const ChartAxis& axis) {
  double widest = 0.0;
  for (const double tick : axis.ticks.values) {
    widest =
        std::max(widest, svg_text_width_px(tick_text(tick, axis.ticks.decimals), kTickSize_px));
  }
  return widest;
}

void draw_upright_axis(Svg& svg, const ChartAxis& y, double left_px, double right_px,
                       const std::string& title, double title_x_px) {
  for (const double tick : y.ticks.values) {
    svg.line({left_px, y(tick)}, {right_px, y(tick)}, kChartGrid, 1.0);
    svg.text({left_px - 8.0, y(tick) + 4.0}, tick_text(tick, y.ticks.decimals),
             {.size_px = kTickSize_px, .color = kChartFaintInk, .anchor = SvgAnchor::kEnd});
  }
  const double length = std::fabs(y.begin_px - y.end_px);
  svg.text({title_x_px, (y.begin_px + y.end_px) / 2.0},
           svg_fitted(title, kTitleSize_px, length + 24.0),
           {.size_px = kTitleSize_px, .anchor = SvgAnchor::kMiddle, .upwards = true});
}

void draw_tick_lines(Svg& svg, const ChartAxis& x, double top_px, double bottom_px) {
  for (const double tick : x.ticks.values) {
    svg.line({x(tick), top_px}, {x(tick), bottom_px}, kChartGrid, 1.0);
  }
}

void draw_level_axis(Svg& svg, const ChartAxis& x, double y_px, const std::string& title) {
  svg.line({x.begin_px, y_px}, {x.end_px, y_px}, kChartInk, 1.2);
  for (const double tick : x.ticks.values) {
    svg.line({x(tick), y_px}, {x(tick), y_px + 5.0}, kChartInk, 1.2);
    svg.text({x(tick), y_px + 19.0}, tick_text(tick, x.ticks.decimals),
             {.size_px = kTickSize_px, .color = kChartFaintInk, .anchor = SvgAnchor::kMiddle});
  }
  svg.text({(x.begin_px + x.end_px) / 2.0, y_px + 42.0}, title,
           {.size_px = kTitleSize_px, .anchor = SvgAnchor::kMiddle});
}

double level_axis_height_px(const std::string& title) {
  return title.empty() ? 26.0 : 50.0;
}

namespace {

constexpr double kLegendSize_px = 12.0;
constexpr double kSample_px = 18.0;  // of a legend: the coloured square and the gap behind it

bool breaks_before(const ChartSeries& series, std::size_t point) {
  return series.jump > 0.0 &&
         std::abs(series.points[point].y - series.points[point - 1].y) > series.jump;
}

}  // namespace

Color series_color(const std::vector<ChartSeries>& series, std::size_t index) {
  return series[index].color.value_or(line_color(index));
}

void add_to_ranges(const std::vector<ChartSeries>& series, ValueRange& x, ValueRange& y) {
  for (const ChartSeries& one : series) {
    for (const ChartPoint& point : one.points) {
      x.add(point.x);
      y.add(point.y - point.error);
      y.add(point.y + point.error);
    }
  }
}

bool check_series(const std::string& chart, const std::vector<ChartSeries>& series) {
  bool any = false;
  for (const ChartSeries& one : series) {
    for (const ChartPoint& point : one.points) {
      any = true;
      if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.error)) {
        throw InputError("chart '" + chart + "': a number of '" + one.label + "' is not finite");
      }
    }
  }
  return any;
}

void draw_error_bar(Svg& svg, double x_px, const ChartAxis& y, const ChartPoint& point,
                    Color color) {
  if (point.error <= 0.0) return;
  const double top = y(point.y + point.error);
  const double bottom = y(point.y - point.error);
  svg.line({x_px, top}, {x_px, bottom}, color, 1.4);
  svg.line({x_px - 4.0, top}, {x_px + 4.0, top}, color, 1.4);
  svg.line({x_px - 4.0, bottom}, {x_px + 4.0, bottom}, color, 1.4);
}

void draw_series(Svg& svg, const ChartAxis& x, const ChartAxis& y, const ChartSeries& series,
                 Color color) {
  std::vector<Pixel> pixels;
  pixels.reserve(series.points.size());
  for (const ChartPoint& point : series.points) pixels.push_back({x(point.x), y(point.y)});
  if (!series.joined) {
    constexpr double kDot_px = 3.0;  // smaller than the bar's ends are wide: short bars are seen
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      if (series.markers) {
        svg.marker(pixels[i], kDot_px, color);
      } else {
        svg.small_dot(pixels[i], color);
      }
      draw_error_bar(svg, pixels[i].x, y, series.points[i], color);
    }
    return;
  }
  for (std::size_t begin = 0, end = 0; begin < pixels.size(); begin = end) {
    end = begin + 1;
    while (end < pixels.size() && !breaks_before(series, end)) ++end;
    const auto at = [&](std::size_t i) { return pixels.begin() + static_cast<std::ptrdiff_t>(i); };
    if (end - begin > 1) svg.polyline({at(begin), at(end)}, color, 2.0, series.dashed);
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    draw_error_bar(svg, pixels[i].x, y, series.points[i], color);
    // A single point has no line to be seen by.
    if (series.markers || pixels.size() == 1) svg.marker(pixels[i], 4.2, color);
  }
}

std::vector<LegendPlace> legend_places(const std::vector<LegendEntry>& entries, double width_px) {
  constexpr double kGap_px = 20.0;
  std::vector<LegendPlace> places;
  places.reserve(entries.size());
  LegendPlace next{0, 0.0};
  for (const LegendEntry& entry : entries) {
    const double width = kSample_px + svg_text_width_px(entry.label, kLegendSize_px);
    if (next.left_px > 0.0 && next.left_px + width > width_px) next = {next.row + 1, 0.0};
    places.push_back(next);
    next.left_px += width + kGap_px;
  }
  return places;
}

double legend_height_px(const std::vector<LegendEntry>& entries, double width_px) {
  if (entries.empty()) return 0.0;
  const std::size_t rows = legend_places(entries, width_px).back().row + 1;
  return static_cast<double>(rows) * kLegendRow_px;
}

void draw_legend(Svg& svg, const std::vector<LegendEntry>& entries, double left_px, double top_px,
                 double width_px) {
  const std::vector<LegendPlace> places = legend_places(entries, width_px);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const double left = left_px + places[i].left_px;
    const double top = top_px + static_cast<double>(places[i].row) * kLegendRow_px;
    svg.rectangle({left, top + 2.0, 12.0, 12.0}, entries[i].color, 2.0);
    svg.text({left + kSample_px, top + 12.0},
             svg_fitted(entries[i].label, kLegendSize_px, width_px - kSample_px),
             {.size_px = kLegendSize_px});
  }
}

std::vector<LegendEntry> legend_of(const std::vector<ChartSeries>& series) {
  std::vector<LegendEntry> entries;
  for (std::size_t i = 0; i < series.size(); ++i) {
    if (!series[i].label.empty()) entries.push_back({series[i].label, series_color(series, i)});
  }
  return entries;
}

}  // namespace screed
