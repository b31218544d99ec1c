#include "host_sim/render/chart/chart_axis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

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
  char text[60];
  std::snprintf(text, sizeof text, "%.*f", decimals, std::fabs(value));
  std::string grouped = text;
  const size_t point = std::min(grouped.find('.'), grouped.size());
  for (size_t at = point; at > 3; at -= 3) grouped.insert(at - 3, "\u2009");
  return (value < 0.0 ? "\u2212" : "") + grouped;
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

}  // namespace screed
