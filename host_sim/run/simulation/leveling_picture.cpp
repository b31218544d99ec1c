#include "host_sim/run/simulation/leveling_picture.h"

#include <cmath>
#include <utility>

#include "host_sim/core/display_units.h"
#include "host_sim/core/errors.h"
#include "host_sim/render/chart/path_map.h"
#include "host_sim/render/chart/stacked_chart.h"
#include "host_sim/render/picture/terrain_picture.h"

namespace screed {
namespace {

constexpr int kWidth_px = 1400;
constexpr int kHeight_px = 596;
constexpr double kHead_px = 62.0;
constexpr double kMap_px = 450.0;  // width of each map's box
constexpr int kImageSide_px = 720;
constexpr double kPerCent = 100.0;
constexpr double kSecondsPerMinute = 60.0;
constexpr Color kReliefColor{0.84, 0.37, 0.0};
constexpr Color kRoughnessColor{0.55, 0.58, 0.61};
constexpr Color kTransportColor{0.10, 0.33, 0.62};

/// From level ground there is no change in per cent.
std::string change_text(double before, double after) {
  std::string text =
      number_text(before * kMmPerM, 1) + " \u2192 " + number_text(after * kMmPerM, 1) + " mm";
  const double change = std::round((after / before - 1.0) * kPerCent);
  if (!std::isfinite(change)) return text;
  return text + " (" + (change > 0.0 ? "+" : "") + number_text(change, 0) + " %)";
}

PathMap map_of(const std::string& title, const HeightField& field, const HeightRange& heights,
               HeightPainter& painter) {
  PathMap map;
  map.title = title;
  map.image = height_map_image(field, heights, kImageSide_px, painter);
  map.scale = height_color_scale(heights);
  return map;
}

/// A curve of what was measured; `value` is not a number where it was not.
template <class Value>
ChartSeries series_of(const std::string& label, std::span<const LevelingPoint> points, Color color,
                      const Value& value) {
  ChartSeries series{label, {}, false, true, false, 0.0, color};
  for (const LevelingPoint& point : points) {
    const double y = value(point);
    if (std::isfinite(y)) series.points.push_back({point.time / kSecondsPerMinute, y});
  }
  return series;
}

StackedChart curves(std::span<const LevelingPoint> points) {
  StackedChart chart;
  chart.x_label = "time [min]";
  chart.x.add(0.0);
  ChartPanel heights{"RMS of heights [mm]", {}, {}, true};
  heights.series.push_back(series_of("relief, from 50 mm up", points, kReliefColor,
                                     [](const LevelingPoint& p) { return p.relief * kMmPerM; }));
  heights.series.push_back(series_of("roughness, below", points, kRoughnessColor,
                                     [](const LevelingPoint& p) { return p.roughness * kMmPerM; }));
  chart.panels.push_back(std::move(heights));
  ChartPanel transport{"transport left [%]", {}, {}, true};
  transport.series.push_back(series_of("", points, kTransportColor, [](const LevelingPoint& p) {
    return (1.0 - p.progress) * kPerCent;
  }));
  if (!transport.series[0].points.empty()) chart.panels.push_back(std::move(transport));
  return chart;
}

}  // namespace

std::string leveling_svg(const std::string& title, const HeightField& before,
                         const HeightField& after, std::span<const LevelingPoint> points) {
  if (points.size() < 2) {
    throw InputError("leveling picture: " + std::to_string(points.size()) +
                     " points of a curve; allowed: at least 2");
  }
  constexpr double kLeft_px = 24.0;
  Svg svg(kWidth_px, kHeight_px);
  svg.text({kLeft_px, 30.0}, svg_fitted(title, 17.0, kWidth_px - 2.0 * kLeft_px),
           {.size_px = 17.0, .bold = true});
  svg.text({kLeft_px, 52.0},
           "relief at the robot's scale " +
               change_text(points.front().relief, points.back().relief) + ",  roughness below it " +
               change_text(points.front().roughness, points.back().roughness),
           {.size_px = 13.0, .color = kChartFaintInk});
  const HeightRange heights = common_range(before, after);
  HeightPainter painter;
  constexpr double kBelow_px = kHeight_px - kHead_px - 8.0;
  draw_path_map(svg, map_of("before", before, heights, painter),
                {4.0, kHead_px, kMap_px, kBelow_px});
  draw_path_map(svg, map_of("after", after, heights, painter),
                {4.0 + kMap_px, kHead_px, kMap_px, kBelow_px});
  constexpr double kRight_px = 4.0 + 2.0 * kMap_px + 8.0;
  draw_stacked_chart(svg, curves(points),
                     {kRight_px, kHead_px, kWidth_px - kRight_px - 8.0, kBelow_px});
  return svg.finish();
}

}  // namespace screed
