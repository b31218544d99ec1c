#include "host_sim/render/chart/path_map.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/grey_image.h"
#include "host_sim/render/chart/chart_parts.h"

namespace screed {
namespace {

constexpr double kMapTitle_px = 26.0;
constexpr double kLeft_px = 62.0;
constexpr double kRight_px = 16.0;
constexpr double kColorBar_px = 58.0;

struct MapRanges {
  ValueRange x;
  ValueRange y;
};

MapRanges ranges_of(const PathMap& map) {
  MapRanges ranges;
  for (const MapPath& path : map.paths) {
    for (const Pixel& point : path.points) {
      if (!std::isfinite(point.x) || !std::isfinite(point.y)) {
        throw InputError("map '" + map.title + "': a place of '" + path.label + "' is not finite");
      }
      ranges.x.add(point.x);
      ranges.y.add(point.y);
    }
  }
  if (map.view.has_value()) {
    ranges.x = {map.view->x_min, map.view->x_max};
    ranges.y = {map.view->y_min, map.view->y_max};
  } else if (map.image.has_value()) {
    const MapRectangle& ground = map.image->ground;
    ranges.x.add(ground.x_min);
    ranges.x.add(ground.x_max);
    ranges.y.add(ground.y_min);
    ranges.y.add(ground.y_max);
  } else {
    // Paths alone get some air, so that none lies on the frame.
    const double air =
        0.06 * std::max({ranges.x.high - ranges.x.low, ranges.y.high - ranges.y.low, 0.05});
    ranges.x = {ranges.x.low - air, ranges.x.high + air};
    ranges.y = {ranges.y.low - air, ranges.y.high + air};
  }
  if (ranges.x.low > ranges.x.high) throw InputError("map '" + map.title + "': nothing to draw");
  return ranges;
}

Color color_of(const PathMap& map, std::size_t path) {
  return map.paths[path].color.value_or(line_color(path));
}

void draw_path(Svg& svg, const MapPath& path, const ChartAxis& x, const ChartAxis& y, Color color,
               bool dashed) {
  std::vector<Pixel> piece;
  const auto end_piece = [&] {
    if (piece.size() > 1) svg.polyline(piece, color, 2.4, dashed);
    piece.clear();
  };
  auto next_break = path.breaks.begin();
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    if (next_break != path.breaks.end() && *next_break == i) {
      end_piece();
      ++next_break;
    }
    piece.push_back({x(path.points[i].x), y(path.points[i].y)});
  }
  end_piece();
}

void draw_ends(Svg& svg, const MapPath& path, const ChartAxis& x, const ChartAxis& y, Color color) {
  if (path.points.empty()) return;
  const Pixel& start = path.points.front();
  const Pixel& end = path.points.back();
  constexpr double kHalf_px = 6.0;
  svg.ring({x(start.x), y(start.y)}, kHalf_px, color);
  const PixelBox square{x(end.x) - kHalf_px, y(end.y) - kHalf_px, 2.0 * kHalf_px, 2.0 * kHalf_px};
  svg.rectangle(square, color);
  svg.frame(square, {1.0, 1.0, 1.0}, 1.4);
}

void draw_color_bar(Svg& svg, const ColorScale& scale, const PixelBox& box) {
  constexpr int kSteps = 96;
  constexpr double kBar_px = 12.0;
  for (int i = 0; i < kSteps; ++i) {
    const double value = scale.low + (scale.high - scale.low) * (i + 0.5) / kSteps;
    svg.rectangle({box.left + box.width * i / kSteps, box.top, box.width / kSteps + 0.6, kBar_px},
                  scale.color(value));
  }
  ValueRange range{scale.low, scale.high};
  range.open();
  const ChartAxis axis = tight_axis(range, 0.0, box.left, box.left + box.width);
  draw_level_axis(svg, axis, box.top + kBar_px, scale.label);
}

}  // namespace

void draw_path_map(Svg& svg, const PathMap& map, const PixelBox& box) {
  const MapRanges ranges = ranges_of(map);
  std::vector<LegendEntry> legend;
  legend.reserve(map.paths.size());
  for (std::size_t i = 0; i < map.paths.size(); ++i) {
    legend.push_back({map.paths[i].label, color_of(map, i)});
  }
  const double legend_width = box.width - kLeft_px - kRight_px;
  const double legend_px = legend_height_px(legend, legend_width);
  const double top = box.top + kMapTitle_px + 12.0 + legend_px;
  const double scale_px = map.scale.has_value() ? kColorBar_px + 14.0 : 0.0;
  const double bottom = box.top + box.height - level_axis_height_px("east [m]") - scale_px;
  const double width_m = ranges.x.high - ranges.x.low;
  const double height_m = ranges.y.high - ranges.y.low;
  const double px_per_m = std::min(legend_width / width_m, (bottom - top) / height_m);
  const PixelBox plot{box.left + kLeft_px, top, width_m * px_per_m, height_m * px_per_m};
  const double plot_bottom = plot.top + plot.height;

  svg.text({plot.left, box.top + 20.0}, svg_fitted(map.title, 14.0, legend_width + 8.0),
           {.size_px = 14.0, .bold = true});
  draw_legend(svg, legend, plot.left, box.top + kMapTitle_px + 4.0, legend_width);

  const ChartAxis x = tight_axis(ranges.x, 0.0, plot.left, plot.left + plot.width);
  ChartAxis y = tight_axis(ranges.y, 0.0, 0.0, plot.height);
  y.begin_px = plot_bottom;
  y.end_px = plot.top;
  draw_tick_lines(svg, x, plot.top, plot_bottom);
  draw_upright_axis(svg, y, plot.left, plot.left + plot.width, "north [m]", box.left + 14.0);
  draw_level_axis(svg, x, plot_bottom, "east [m]");
  svg.begin_clip(plot);
  if (map.image.has_value()) {
    const MapRectangle& ground = map.image->ground;
    svg.image({x(ground.x_min), y(ground.y_max), x(ground.x_max) - x(ground.x_min),
               y(ground.y_min) - y(ground.y_max)},
              rgb_png(map.image->width, map.image->height, map.image->rgb));
  }
  // The later paths are dashed: where they cover the first, it shows between the dashes.
  for (std::size_t i = 0; i < map.paths.size(); ++i) {
    draw_path(svg, map.paths[i], x, y, color_of(map, i), i > 0);
  }
  for (std::size_t i = 0; i < map.paths.size(); ++i)
    draw_ends(svg, map.paths[i], x, y, color_of(map, i));
  svg.end_clip();
  svg.frame(plot, kChartInk, 1.2);
  if (map.scale.has_value()) {
    draw_color_bar(svg, *map.scale,
                   {plot.left, plot_bottom + level_axis_height_px("east [m]") + 8.0,
                    std::max(plot.width, 240.0), kColorBar_px});
  }
}

}  // namespace screed
