#include "tools/screed/nn/rollout_picture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/core/constants.h"
#include "host_sim/render/chart/path_map.h"
#include "host_sim/render/chart/stacked_chart.h"

namespace screed {
namespace {

MapPath map_path(const std::string& label, const std::vector<PlanarPose>& poses) {
  MapPath path{label, {}};
  path.points.reserve(poses.size());
  for (const PlanarPose& pose : poses) path.points.push_back({pose.x_m, pose.y_m});
  return path;
}

}  // namespace

std::vector<RolloutDeviation> rollout_deviation(const std::vector<PlanarPose>& physics,
                                                const std::vector<PlanarPose>& predicted) {
  std::vector<RolloutDeviation> deviation;
  const std::size_t count = std::min(physics.size(), predicted.size());
  deviation.reserve(count);
  double distance = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const PlanarPose& real = physics[i];
    const PlanarPose& pose = predicted[i];
    if (i > 0) distance += std::hypot(real.x_m - physics[i - 1].x_m, real.y_m - physics[i - 1].y_m);
    deviation.push_back(
        {distance, std::hypot(pose.x_m - real.x_m, pose.y_m - real.y_m),
         kDegPerRad * std::remainder(pose.heading_rad - real.heading_rad, 2.0 * std::numbers::pi)});
  }
  return deviation;
}

std::string rollout_svg(const RolloutPicture& picture) {
  constexpr int kWidth_px = 1200;
  constexpr int kHeight_px = 560;
  constexpr double kTop_px = 40.0;
  constexpr double kMap_px = 520.0;

  PathMap map;
  map.title = "paths from above";
  map.paths.push_back(map_path("physics", picture.physics));

  // An empty first series has the physics' place, so that each prediction has one colour.
  ChartPanel position{"position deviation [mm]", {{"", {}, false}}, {}, true};
  ChartPanel heading{"heading deviation [deg]", {{"", {}, false}}, {}, false};
  for (const PredictedPath& prediction : picture.predictions) {
    map.paths.push_back(map_path(prediction.name, prediction.poses));
    ChartSeries apart{prediction.name, {}, false};
    ChartSeries turned{prediction.name, {}, false};
    for (const RolloutDeviation& it : rollout_deviation(picture.physics, prediction.poses)) {
      apart.points.push_back({it.distance_m, 1e3 * it.position_m});
      turned.points.push_back({it.distance_m, it.heading_deg});
    }
    position.series.push_back(std::move(apart));
    heading.series.push_back(std::move(turned));
  }
  StackedChart chart;
  chart.title = "prediction against physics";
  chart.x_label = "distance driven by the physics [m]";
  chart.panels = {std::move(position), std::move(heading)};

  Svg svg(kWidth_px, kHeight_px);
  svg.text({20.0, 28.0}, svg_fitted(picture.title, 16.0, kWidth_px - 40.0),
           {.size_px = 16.0, .bold = true});
  draw_path_map(svg, map, {6.0, kTop_px, kMap_px, kHeight_px - kTop_px - 6.0});
  draw_stacked_chart(svg, chart,
                     {kMap_px + 10.0, kTop_px, kWidth_px - kMap_px - 10.0, kHeight_px - kTop_px});
  return svg.finish();
}

}  // namespace screed
