#include "host_sim/run/simulation/run_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/render/chart/path_map.h"
#include "host_sim/render/chart/stacked_chart.h"
#include "host_sim/render/chart/svg.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/simulation/outcome.h"
#include "host_sim/run/simulation/recorders.h"

namespace screed {

namespace {

constexpr int kWidth_px = 1400;
constexpr int kHeight_px = 596;
constexpr double kHead_px = 62.0;
constexpr double kMap_px = 450.0;  // width of each map's box
constexpr int kImageSide_px = 720;
constexpr double kPerCent = 100.0;
constexpr double kSecondsPerMinute = 60.0;
constexpr Color kLevelColor{0.13, 0.47, 0.25};
constexpr Color kReliefColor{0.84, 0.37, 0.0};
constexpr Color kRoughnessColor{0.55, 0.58, 0.61};
constexpr Color kTransportColor{0.10, 0.33, 0.62};
constexpr Color kSquaredColor{0.55, 0.25, 0.60};

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
  heights.series.push_back(
      series_of("about level (50 mm and longer)", points, kLevelColor,
                [](const LevelingPoint& p) { return p.level_deviation * kMmPerM; }));
  heights.series.push_back(series_of("relief: slant taken off", points, kReliefColor,
                                     [](const LevelingPoint& p) { return p.relief * kMmPerM; }));
  heights.series.push_back(series_of("roughness (shorter)", points, kRoughnessColor,
                                     [](const LevelingPoint& p) { return p.roughness * kMmPerM; }));
  chart.panels.push_back(std::move(heights));
  ChartPanel transport{"work remaining [%]", {}, {}, true};
  transport.series.push_back(series_of("W1", points, kTransportColor, [](const LevelingPoint& p) {
    return (1.0 - p.progress) * kPerCent;
  }));
  const double squared_m5 = points.front().transport_squared;
  transport.series.push_back(series_of("W2", points, kSquaredColor, [&](const LevelingPoint& p) {
    return std::sqrt(p.transport_squared / squared_m5) * kPerCent;
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
           "height about level " +
               change_text(points.front().level_deviation, points.back().level_deviation) +
               ",  relief (the slant of the bed taken off) " +
               change_text(points.front().relief, points.back().relief) + ",  roughness " +
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

// Titles, legend and outline of a run's pictures.

namespace {

namespace fs = std::filesystem;

constexpr double kDrawnSides = 20.0;  ///< of the bed: the longest path that is drawn

void add_robot(const SessionReader& session, const std::optional<RobotShape>& shape,
               DrivenRun& run) {
  std::vector<PathPoint> path;
  const SimFrame last =
      for_each_frame(session, session.frames(), [&](std::uint64_t row, const SimFrame& frame) {
        if (row % kPathTicks == 0) path.push_back(path_point(frame));
      });
  add_robot(std::move(path), last, shape, run);
}

}  // namespace

void add_robot(std::vector<PathPoint> path, const SimFrame& last,
               const std::optional<RobotShape>& shape, DrivenRun& run) {
  PictureRobot& robot = run.robots.emplace_back();
  robot.path = std::move(path);
  if (robot.path.empty()) return;
  run.time_s = std::max(run.time_s, last.time);
  if (shape) robot.outline = RobotOutline{last.x, last.y, last.yaw, *shape};
}

std::span<const PathPoint> last_stretch(std::span<const PathPoint> path, double length_m,
                                        double bed_m) {
  std::size_t first = path.size();
  double length = 0.0;
  while (first > 0) {
    if (first < path.size()) {
      const PathPoint& behind = path[first];
      const PathPoint& point = path[first - 1];
      const double step_m = portable::hypot(behind.x_m - point.x_m, behind.y_m - point.y_m);
      if (step_m <= 0.5 * bed_m) length += step_m;
      if (length > length_m) break;
    }
    --first;
  }
  return path.subspan(first);
}

std::vector<fs::path> write_run_pictures(const fs::path& folder, const Experiment& experiment,
                                         const RunSurfaces& terrain, const DrivenRun& run) {
  const std::string& name = experiment.experiment.name;
  const std::string what =
      std::to_string(std::lround(run.time_s)) + " s of " + experiment.experiment.algorithm;
  std::vector<fs::path> files;
  PictureOptions options;
  if (experiment.map.is_soil() || experiment.map.of_particles() ||
      !terrain_change(terrain.before, terrain.after).is_none()) {
    // Without the path, which would hide the tracks below it.
    options.title = name + ": change by " + what;
    files.push_back(folder / "terrain_change.png");
    write_difference_picture(files.back(), terrain.before, terrain.after, options);
    if (run.leveling.size() > 1) {
      files.push_back(folder / "leveling.png");
      write_svg_as_png(
          files.back(),
          leveling_svg(name + ": " + what, terrain.before, terrain.after, run.leveling), 1.0);
    }
  }
  options.heights = common_range(terrain.before, terrain.after);
  options.title = name + ": before";
  files.push_back(folder / "terrain_before.png");
  HeightPainter painter;
  write_height_map_picture(files.back(), terrain.before, options, painter);

  options.title = name + ": after " + what;
  const int cells_x = terrain.after.cells_x();
  const int cells_y = terrain.after.cells_y();
  const double drawn_m = kDrawnSides * terrain.after.spacing_m() * std::max(cells_x, cells_y);
  const auto drawn = [&](const std::vector<PathPoint>& path) {
    const std::span<const PathPoint> end =
        last_stretch(path, drawn_m, terrain.after.spacing_m() * std::min(cells_x, cells_y));
    if (end.size() < path.size()) options.paths_from_start = false;
    return std::vector<PathPoint>(end.begin(), end.end());
  };
  options.state_names = leveling_state_names();
  options.robots = run.robots;
  for (PictureRobot& robot : options.robots) robot.path = drawn(robot.path);
  if (!options.paths_from_start)
    options.title += ", path of the last " + std::to_string(std::lround(drawn_m)) + " m";
  files.push_back(folder / "terrain_after.png");
  write_height_map_picture(files.back(), terrain.after, options, painter);
  return files;
}

std::vector<fs::path> export_run_pictures(const fs::path& folder,
                                          std::span<const SessionReader> sessions,
                                          const std::optional<RobotShape>& shape) {
  const SessionReader& session = sessions.front();
  const std::optional<HeightMap> before = session.terrain_before();
  const std::optional<HeightMap> after = session.terrain_after();
  if (!before || !after) return {};
  if (before->geometry != after->geometry) {
    throw InputError("the session's terrains before and after have different grids");
  }
  const Experiment experiment = setup_of(session.info(), {}).experiment;
  const TerrainMeasure measure(experiment);
  DrivenRun driven;
  for (const SessionReader& robot : sessions) add_robot(robot, shape, driven);
  driven.leveling = session.leveling();
  return write_run_pictures(folder, experiment,
                            {measure.surface(field_of(*before)), measure.surface(field_of(*after))},
                            driven);
}

}  // namespace screed
