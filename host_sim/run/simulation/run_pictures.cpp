// Titles, legend and outline of a run's pictures.
#include "host_sim/run/simulation/run_pictures.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <utility>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/render/chart/svg_png.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/height_export.h"
#include "host_sim/run/simulation/leveling_picture.h"
#include "host_sim/run/simulation/names.h"
#include "host_sim/run/simulation/session_recorder.h"
#include "host_sim/run/simulation/terrain_outcome.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr double kDrawnSides = 20.0;  ///< of the bed: the longest path that is drawn

void add_robot(const SessionReader& session, const std::optional<RobotShape>& shape,
               DrivenRun& run) {
  constexpr std::uint64_t kBlockRows = 1024;
  std::vector<PathPoint> path;
  std::vector<SimFrame> frames;
  for (std::uint64_t first = 0; first < session.frames(); first += frames.size()) {
    frames.resize(std::min(kBlockRows, session.frames() - first));
    session.read(first, std::span(frames));
    for (std::size_t i = 0; i < frames.size(); ++i) {
      if ((first + i) % kPathTicks == 0) path.push_back(path_point(frames[i]));
    }
  }
  add_robot(std::move(path), frames.empty() ? SimFrame() : frames.back(), shape, run);
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
