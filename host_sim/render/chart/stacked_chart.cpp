#include "host_sim/render/chart/stacked_chart.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr double kMargin_px = 24.0;
constexpr double kTitle_px = 20.0;  // of a line of the title
constexpr double kBelowTitle_px = 6.0;
constexpr double kTitleColumn_px = 22.0;  // of the upright title of an axis
constexpr double kPanelGap_px = 16.0;     // below a panel
constexpr double kBandRow_px = 26.0;      // of a row of bands, with the gap below it
constexpr double kBand_px = 20.0;         // of the band itself
constexpr double kBandTextSize_px = 11.5;
constexpr double kRowLabelSize_px = 12.0;
constexpr double kMaxLabel_px = 200.0;
constexpr double kGoodPanel_px = 180.0;  // of the axis of a panel of lines
constexpr double kOnlyPanel_px = 340.0;
constexpr double kMinPanel_px = 70.0;

void check_band(const StackedChart& chart, const BandRow& row, const ChartBand& band) {
  if (!std::isfinite(band.begin) || !std::isfinite(band.end) || band.end < band.begin) {
    throw InputError("chart '" + chart.title + "': a band of '" + row.label + "' has no duration");
  }
}

void check(const StackedChart& chart) {
  // A panel of states that never held is worth a picture when its time is known.
  bool any = !chart.panels.empty() && chart.x.low < chart.x.high;
  for (const ChartPanel& panel : chart.panels) {
    any |= check_series(chart.title, panel.series);
    for (const BandRow& row : panel.rows) {
      for (const ChartBand& band : row.bands) {
        check_band(chart, row, band);
        any = true;
      }
    }
  }
  if (!any) throw InputError("chart '" + chart.title + "': nothing to draw");
}

/// Where a panel stands.
struct PanelPlace {
  std::vector<LegendEntry> legend;
  double legend_top = 0.0;
  double top = 0.0;
  double bottom = 0.0;
  ChartAxis y;
};

class StackedDrawing {
 public:
  StackedDrawing(const StackedChart& chart, const PixelBox& box) : chart_(chart), box_(box) {
    find_x_range();
    margin_px_ = margin_px(flexible_panels() > 1.0 ? kGoodPanel_px : kOnlyPanel_px);
  }

  /// What the panels need, their axes with this length.
  double height_px(double axis_px) const {
    double height = head_px() + level_axis_height_px(chart_.x_label) + 6.0;
    for (const ChartPanel& panel : chart_.panels) height += panel_px(panel, axis_px);
    return height;
  }

  void draw(Svg& svg) {
    lay_out();
    draw_words(svg);
    for (size_t i = 0; i < chart_.panels.size(); ++i) draw_panel(svg, i);
    draw_level_axis(svg, x_, places_.back().bottom, chart_.x_label);
  }

  double flexible_panels() const {
    return static_cast<double>(
        std::count_if(chart_.panels.begin(), chart_.panels.end(),
                      [](const ChartPanel& panel) { return panel.rows.empty(); }));
  }

 private:
  double head_px() const {
    return 8.0 + (chart_.title.empty() ? 0.0 : kTitle_px + kBelowTitle_px) +
           (chart_.subtitle.empty() ? 0.0 : kTitle_px);
  }
  /// As wide as the axis, at the left end of which it stands.
  double legend_width_px() const { return box_.width - 2.0 * kMargin_px - margin_px_; }

  /// Left of the axes, for labels, ticks and titles, when upright axes have that length.
  double margin_px(double axis_px) const {
    double margin = 0.0;
    for (const ChartPanel& panel : chart_.panels) {
      if (panel.rows.empty()) {
        const double ticks = tick_width_px(axis_of(panel, axis_px, 0.0));
        margin = std::max(margin, ticks + (panel.title.empty() ? 0.0 : kTitleColumn_px));
      }
      for (const BandRow& row : panel.rows) {
        const double label = svg_text_width_px(row.label, kRowLabelSize_px);
        margin = std::max(margin, std::min(kMaxLabel_px, label));
      }
    }
    return margin;
  }

  /// An axis title names a single series; several have a legend, and so have the names that fit
  /// into none of their bands.
  std::vector<LegendEntry> panel_legend(const ChartPanel& panel) const {
    if (!panel.rows.empty()) return band_legend(panel);
    return panel.series.size() > 1 || panel.title.empty() ? legend_of(panel.series)
                                                          : std::vector<LegendEntry>{};
  }

  std::vector<LegendEntry> band_legend(const ChartPanel& panel) const {
    // The axis is laid out later; it will not be shorter.
    const double px_per_x =
        (box_.width - 2.0 * kMargin_px - kMaxLabel_px) / (1.02 * (x_range_.high - x_range_.low));
    std::vector<LegendEntry> entries;
    for (const BandRow& row : panel.rows) {
      for (const ChartBand& band : row.bands) {
        const auto fits = [&](const ChartBand& other) {
          return other.name == band.name &&
                 has_room((other.end - other.begin) * px_per_x, other.name);
        };
        const auto known = [&](const LegendEntry& entry) { return entry.label == band.name; };
        if (!band.name.empty() && std::none_of(row.bands.begin(), row.bands.end(), fits) &&
            std::none_of(entries.begin(), entries.end(), known)) {
          entries.push_back({band.name, band.color});
        }
      }
    }
    return entries;
  }
  /// Whether the name can be written into a band of that width.
  static bool has_room(double width_px, const std::string& name) {
    return svg_text_width_px(name, kBandTextSize_px) + 6.0 <= width_px;
  }

  double panel_px(const ChartPanel& panel, double axis_px) const {
    const double content =
        panel.rows.empty() ? axis_px : static_cast<double>(panel.rows.size()) * kBandRow_px;
    return kPanelGap_px + legend_height_px(panel_legend(panel), legend_width_px()) + content;
  }

  void find_x_range() {
    ValueRange ignored;
    x_range_ = chart_.x;
    for (const ChartPanel& panel : chart_.panels) {
      add_to_ranges(panel.series, x_range_, ignored);
      for (const BandRow& row : panel.rows) {
        for (const ChartBand& band : row.bands) {
          x_range_.add(band.begin);
          x_range_.add(band.end);
        }
      }
    }
    x_range_.open();
  }

  void lay_out() {
    double axis_px = shared_axis_px();
    // Ticks of the length that the axes come to may be wider than those of a good length, and then
    // a legend may take one more row.
    margin_px_ = std::max(margin_px_, margin_px(axis_px));
    axis_px = shared_axis_px();
    if (axis_px < kMinPanel_px && flexible_panels() > 0.0) {
      throw InputError("chart '" + chart_.title + "': " + std::to_string(std::lround(box_.height)) +
                       " px are too few for " + std::to_string(chart_.panels.size()) +
                       " panels; they need " +
                       std::to_string(std::lround(std::ceil(height_px(kMinPanel_px)))));
    }
    double top = box_.top + head_px();
    double ticks = 0.0;
    for (const ChartPanel& panel : chart_.panels) {
      PanelPlace place;
      place.legend_top = top;
      const double height = panel_px(panel, axis_px) - kPanelGap_px;
      place.legend = panel_legend(panel);
      place.top = top + legend_height_px(place.legend, legend_width_px());
      place.bottom = top + height;
      if (panel.rows.empty()) {
        place.y = axis_of(panel, place.bottom, place.top);
        ticks = std::max(ticks, tick_width_px(place.y));
      }
      top += height + kPanelGap_px;
      places_.push_back(std::move(place));
    }
    x_ = tight_axis(x_range_, 0.01, box_.left + kMargin_px + margin_px_,
                    box_.left + box_.width - kMargin_px);
    title_x_px_ = x_.begin_px - 8.0 - ticks - 16.0;
  }

  /// Of each of the panels whose height is free.
  double shared_axis_px() const {
    return flexible_panels() > 0.0 ? (box_.height - height_px(0.0)) / flexible_panels() : 0.0;
  }

  static ChartAxis axis_of(const ChartPanel& panel, double bottom_px, double top_px) {
    ValueRange ignored;
    ValueRange range;
    add_to_ranges(panel.series, ignored, range);
    range.open(panel.from_zero);
    constexpr double kTickDistance_px = 42.0;
    return enclosing_axis(range, static_cast<int>((bottom_px - top_px) / kTickDistance_px),
                          bottom_px, top_px);
  }

  void draw_words(Svg& svg) const {
    double y = box_.top + 22.0;
    const double left = x_.begin_px;
    const double room = box_.left + box_.width - left - 8.0;
    svg.text({left, y}, svg_fitted(chart_.title, 16.0, room), {.size_px = 16.0, .bold = true});
    if (!chart_.title.empty()) y += kTitle_px;
    svg.text({left, y}, svg_fitted(chart_.subtitle, 12.0, room), {.color = kChartFaintInk});
  }

  void draw_panel(Svg& svg, size_t index) const {
    const ChartPanel& panel = chart_.panels[index];
    const PanelPlace& place = places_[index];
    draw_tick_lines(svg, x_, place.top, place.bottom);
    draw_legend(svg, place.legend, x_.begin_px, place.legend_top - 2.0, legend_width_px());
    if (!panel.rows.empty()) {
      for (size_t row = 0; row < panel.rows.size(); ++row) {
        draw_row(svg, panel.rows[row], place.top + static_cast<double>(row) * kBandRow_px);
      }
      return;
    }
    draw_upright_axis(svg, place.y, x_.begin_px, x_.end_px, panel.title, title_x_px_);
    for (size_t i = 0; i < panel.series.size(); ++i) {
      draw_series(svg, x_, place.y, panel.series[i], series_color(panel.series, i));
    }
  }

  /// A name stands in its band where it fits.
  void draw_row(Svg& svg, const BandRow& row, double top) const {
    const double middle = top + kBand_px / 2.0;
    svg.text({x_.begin_px - 8.0, middle + 4.0},
             svg_fitted(row.label, kRowLabelSize_px, kMaxLabel_px),
             {.size_px = kRowLabelSize_px, .anchor = SvgAnchor::kEnd});
    if (row.bands.empty()) {
      svg.text({x_.begin_px + 6.0, middle + 4.0}, "none",
               {.size_px = kBandTextSize_px, .color = kChartFaintInk});
    }
    for (const ChartBand& band : row.bands) {
      const double left = x_(band.begin);
      const double width = std::max(1.5, x_(band.end) - left);
      svg.rectangle({left, top, width, kBand_px}, band.color);
      if (!has_room(width, band.name)) continue;
      svg.text(
          {left + width / 2.0, middle + 4.0}, band.name,
          {.size_px = kBandTextSize_px, .color = ink_on(band.color), .anchor = SvgAnchor::kMiddle});
    }
  }

  const StackedChart& chart_;
  PixelBox box_;
  ValueRange x_range_;
  ChartAxis x_;
  double margin_px_ = 0.0;
  double title_x_px_ = 0.0;
  std::vector<PanelPlace> places_;
};

}  // namespace

void draw_stacked_chart(Svg& svg, const StackedChart& chart, const PixelBox& box) {
  check(chart);
  StackedDrawing(chart, box).draw(svg);
}

std::string stacked_chart_svg(const StackedChart& chart) {
  check(chart);
  if (chart.width_px < kMinChartWidth_px || chart.width_px > kMaxChartSide_px) {
    throw InputError("chart: " + std::to_string(chart.width_px) + " px wide; allowed is " +
                     std::to_string(kMinChartWidth_px) + " to " + std::to_string(kMaxChartSide_px));
  }
  PixelBox box{0.0, 0.0, static_cast<double>(chart.width_px), 0.0};
  const StackedDrawing trial(chart, box);
  const double good = trial.flexible_panels() > 1.0 ? kGoodPanel_px : kOnlyPanel_px;
  const double height = chart.height_px.has_value() ? *chart.height_px : trial.height_px(good);
  if (height > kMaxChartSide_px) {
    throw InputError("chart '" + chart.title + "': " + std::to_string(chart.panels.size()) +
                     " panels are too many for one picture of " + std::to_string(kMaxChartSide_px) +
                     " px; draw fewer signals");
  }
  box.height = std::ceil(height);
  Svg svg(chart.width_px, static_cast<int>(box.height));
  StackedDrawing(chart, box).draw(svg);
  return svg.finish();
}

}  // namespace screed
