// SVG charts of one panel.
#include "host_sim/render/chart/line_chart.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/atomic_file.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

void check(const Chart& chart) {
  if (chart.width_px < kMinChartWidth_px || chart.width_px > kMaxChartSide_px ||
      chart.height_px < kMinChartHeight_px || chart.height_px > kMaxChartSide_px) {
    const std::string most = std::to_string(kMaxChartSide_px);
    throw InputError("chart: " + std::to_string(chart.width_px) + "x" +
                     std::to_string(chart.height_px) + " px; allowed is " +
                     std::to_string(kMinChartWidth_px) + "x" + std::to_string(kMinChartHeight_px) +
                     " to " + most + "x" + most);
  }
  if (!check_series(chart.title, chart.series)) {
    throw InputError("chart '" + chart.title + "': nothing to draw");
  }
}

class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart), svg_(chart.width_px, chart.height_px) {
    lay_out();
  }

  std::string draw() {
    words();
    draw_upright_axis(svg_, y_, x_.begin_px, x_.end_px, chart_.y_label, 20.0);
    draw_level_axis(svg_, x_, y_.begin_px, chart_.x_label);
    categories();
    for (size_t i = 0; i < chart_.series.size(); ++i) {
      if (chart_.kind == ChartKind::kBars) {
        bars(i);
      } else {
        draw_series(svg_, x_, y_, chart_.series[i], color(i));
      }
    }
    draw_legend(svg_, legend_, x_.begin_px, legend_top_, x_.end_px - x_.begin_px);
    return svg_.finish();
  }

 private:
  bool has_categories() const { return !chart_.categories.empty(); }
  /// Bars are large enough for light colours; lines are not.
  Color color(size_t series) const {
    if (chart_.kind != ChartKind::kBars) return series_color(chart_.series, series);
    return chart_.series[series].color.value_or(category_color(series));
  }

  void lay_out() {
    ValueRange x_range;
    ValueRange y_range;
    add_to_ranges(chart_.series, x_range, y_range);
    y_range.open(chart_.from_zero || chart_.kind == ChartKind::kBars);
    x_range.open();

    legend_ = legend_of(chart_.series);
    for (size_t i = 0, entry = 0; i < chart_.series.size(); ++i) {
      if (!chart_.series[i].label.empty()) legend_[entry++].color = color(i);
    }
    constexpr double kMargin_px = 24.0;
    legend_top_ =
        18.0 + (chart_.title.empty() ? 0.0 : 20.0) + (chart_.subtitle.empty() ? 0.0 : 20.0);
    const double bottom = chart_.height_px - 6.0 - level_axis_height_px(chart_.x_label);
    // The ticks do not depend on where the axis ends, only on its height in the picture.
    y_ = enclosing_axis(y_range, chart_.height_px / 65, bottom, 0.0);
    const double left = kMargin_px + (chart_.y_label.empty() ? 0.0 : 22.0) + tick_width_px(y_);
    y_.end_px = legend_top_ + legend_height_px(legend_, chart_.width_px - kMargin_px - left) +
                (legend_.empty() ? 14.0 : 10.0);
    // Only as wide as the points, with a little air.
    x_ = tight_axis(x_range, 0.03, left, chart_.width_px - kMargin_px);
    if (has_categories()) {
      x_.low = -0.5;
      x_.high = static_cast<double>(chart_.categories.size()) - 0.5;
      x_.ticks.values.clear();
    }
  }

  void words() {
    double y = 26.0;
    const double room = chart_.width_px - x_.begin_px - 8.0;
    svg_.text({x_.begin_px, y}, svg_fitted(chart_.title, 16.0, room * 1.05),
              {.size_px = 16.0, .bold = true});
    if (!chart_.title.empty()) y += 20.0;
    svg_.text({x_.begin_px, y}, chart_.subtitle, {.color = kChartFaintInk});
  }

  void categories() {
    for (size_t i = 0; i < chart_.categories.size(); ++i) {
      svg_.text({x_(static_cast<double>(i)), y_.begin_px + 19.0}, chart_.categories[i],
                {.color = kChartFaintInk, .anchor = SvgAnchor::kMiddle});
    }
  }

  void bars(size_t index) {
    const double slot = x_(1.0) - x_(0.0);
    const auto count = static_cast<double>(chart_.series.size());
    const double width = std::min(90.0, slot * 0.72 / count);
    for (const ChartPoint& point : chart_.series[index].points) {
      const double center =
          x_(point.x) + (static_cast<double>(index) - (count - 1.0) / 2.0) * width;
      const double from = y_(std::clamp(0.0, y_.low, y_.high));
      const double to = y_(point.y);
      svg_.rectangle(
          {center - width / 2.0 + 1.0, std::min(from, to), width - 2.0, std::fabs(from - to)},
          color(index), 2.0);
      draw_error_bar(svg_, center, y_, point, kChartInk);
      const std::string value = tick_text(point.y, value_decimals());
      if (chart_.value_labels && svg_text_width_px(value, 11.5) < width * 1.25) {
        svg_.text({center, y_(point.y + point.error) - 6.0}, value,
                  {.size_px = 11.0, .anchor = SvgAnchor::kMiddle});
      }
    }
  }
  /// Values are written with one digit more than the axis, whole numbers as such.
  int value_decimals() const { return y_.ticks.step >= 10.0 ? 0 : y_.ticks.decimals + 1; }

  const Chart& chart_;
  Svg svg_;
  ChartAxis x_;
  ChartAxis y_;
  std::vector<LegendEntry> legend_;
  double legend_top_ = 0.0;
};

}  // namespace

std::string chart_svg(const Chart& chart) {
  check(chart);
  return Drawing(chart).draw();
}

void write_chart(const std::filesystem::path& path, const Chart& chart) {
  write_file(path, chart_svg(chart));
}

}  // namespace screed
