// From a session to a scene.
#include "host_sim/run/scene/run_scene.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/grey_image.h"
#include "host_sim/physics/vehicle/vehicle.h"
#include "host_sim/render/scene/povray.h"
#include "host_sim/render/scene/robot_scene.h"
#include "host_sim/render/scene/sphere_scene.h"
#include "host_sim/render/scene/terrain_scene.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/run_folder.h"

namespace screed {
namespace {

constexpr double kFieldOfView_deg = 40.0;
constexpr double kMargin = 0.03;  // of the picture, round the bed
constexpr double kPathRadius =
    0.0022;  // of the line that shows the way, to the distance it is seen from

std::vector<SessionReader> robots_of(const std::filesystem::path& run) {
  std::error_code error;
  if (std::filesystem::is_directory(run, error) &&
      !std::filesystem::exists(run / "session.h5", error)) {
    throw InputError(run.string() + ": is not the folder of a run: there is no session.h5 in it");
  }
  return open_robots(run);
}

/// For soil_appearance().
std::string soil_name(const RunSetup& setup) {
  const MapSection& map = setup.experiment.map;
  if (map.is_soil()) return setup.soil;
  return map.of_particles() ? "gravel" : "";
}

/// The robot's way to a frame.
struct DrivenPath {
  SimFrame frame;
  std::vector<Eigen::Vector2d> path;
  std::array<double, 2> travel_m{};
};

DrivenPath path_until(const SessionReader& session, std::uint64_t last) {
  constexpr double kPathStep_m = 0.01;
  DrivenPath driven;
  const double dt = 1.0 / session.info().tick_rate_hz;
  driven.frame = for_each_frame(session, last + 1, [&](std::uint64_t, const SimFrame& frame) {
    driven.travel_m[0] += std::isfinite(frame.track_left) ? frame.track_left * dt : 0.0;
    driven.travel_m[1] += std::isfinite(frame.track_right) ? frame.track_right * dt : 0.0;
    const Eigen::Vector2d at(frame.x, frame.y);
    if (driven.path.empty() || (at - driven.path.back()).norm() >= kPathStep_m)
      driven.path.push_back(at);
  });
  driven.path.emplace_back(driven.frame.x, driven.frame.y);
  return driven;
}

/// At the end of a path. Throws InputError when that is no pose.
RobotPose pose_of(const DrivenPath& driven, const std::filesystem::path& run) {
  RobotPose pose;
  pose.body.linear() = rotation_from({driven.frame.roll, driven.frame.pitch, driven.frame.yaw});
  pose.body.translation() << driven.frame.x, driven.frame.y, driven.frame.z;
  pose.travel_m = driven.travel_m;
  if (!pose.body.matrix().allFinite()) {
    throw InputError(run.string() + ": the robot has no pose at " +
                     std::to_string(driven.frame.time) + " s");
  }
  return pose;
}

std::uint64_t frame_number(const SessionReader& session, const RunSceneOptions& options,
                           const std::filesystem::path& run) {
  const auto count = static_cast<std::int64_t>(session.frames());
  if (count == 0) throw InputError(run.string() + ": no frame was recorded");
  const std::int64_t asked = options.frame.value_or(-1);
  std::int64_t frame = asked < 0 ? count + asked : asked;
  if (options.at_s.has_value()) {
    const double rate_hz = session.info().tick_rate_hz;
    frame = std::llround(*options.at_s * rate_hz);
    if (frame == count) --frame;  // the end of the run is the end of its last frame
    if (frame >= count) {
      throw InputError("--at = " + std::to_string(*options.at_s) +
                       " is after the end: " + run.string() + " lasts " +
                       std::to_string(static_cast<double>(count) / rate_hz) + " s");
    }
  }
  if (frame < 0 || frame >= count) {
    throw InputError("frame = " + std::to_string(asked) + "; " + run.string() +
                     " has frames 0 to " + std::to_string(count - 1));
  }
  return static_cast<std::uint64_t>(frame);
}

struct RecordedTerrain {
  HeightMap now;
  std::optional<HeightMap> before;
  /// Where they were recorded at this frame, or no heights were; they are drawn then.
  std::optional<SphereSet> particles;
  bool is_later = false;
};

RecordedTerrain ground_at(const SessionReader& session, std::uint64_t frame, bool soft,
                          const std::filesystem::path& run) {
  RecordedTerrain ground;
  ground.before = session.terrain_before();
  if (!ground.before) throw InputError(run.string() + ": the session holds no height map");
  const bool first = frame == 0;
  const bool last = frame + 1 == session.frames();
  if (session.has_heights()) {
    ground.now = session.heights_after(frame + 1);
    if (first || last) {
      ground.particles = first ? session.particles_before() : session.particles_after();
    }
    return ground;
  }
  const auto after = session.terrain_after();
  if (frame == 0 || !soft || !after) {
    ground.now = *ground.before;
    ground.particles = session.particles_before();
  } else {
    ground.now = *after;
    ground.particles = session.particles_after();
    ground.is_later = frame + 1 < session.frames();
  }
  return ground;
}

/// What the camera for the whole bed has to see: the bed's corners from the table to the highest
/// place, and the robot.
std::vector<Eigen::Vector3d> bed_points(const TerrainSurface& surface, const RobotPose& pose) {
  constexpr double kBelow_m = 0.06;
  constexpr double kRobot_m = 0.2;  // about its reach
  std::vector<Eigen::Vector3d> points;
  for (const double x : {surface.x_min(), surface.x_min() + surface.width_m()}) {
    for (const double y : {surface.y_min(), surface.y_min() + surface.depth_m()}) {
      points.emplace_back(x, y, surface.lowest_m() - kBelow_m);
      points.emplace_back(x, y, surface.highest_m());
    }
  }
  points.push_back(pose.body.translation() + Eigen::Vector3d(0.0, 0.0, kRobot_m));
  return points;
}

/// One scale for all frames of a run, as far as the session knows it. The lowest places, gaps
/// between stones and the pit of a track, have the colour of those just above.
HeightTint tint_of(const TerrainSurface& now, const HeightMap& before) {
  constexpr double kLowShare = 0.02;
  const auto low_m = [](const HeightMap& map) {
    std::vector<std::int32_t> heights = map.heights;
    const auto low = heights.begin() +
                     static_cast<std::ptrdiff_t>(kLowShare * static_cast<double>(heights.size()));
    std::nth_element(heights.begin(), low, heights.end());
    return *low * map.geometry.unit_m;
  };
  const TerrainSurface first(before);
  return height_tint(std::min(low_m(now.map()), low_m(before)),
                     std::max(now.highest_m(), first.highest_m()));
}

void write_raster(const std::filesystem::path& file, const GreyRaster& raster) {
  write_grey16_png(file, raster.width, raster.height, raster.samples);
}

}  // namespace

RunSceneResult render_run(const std::filesystem::path& run, const std::filesystem::path& picture,
                          const RunSceneOptions& options) {
  const std::vector<SessionReader> robots = robots_of(run);
  const SessionReader& session = robots.front();
  if (!session.complete()) {
    throw InputError(run.string() +
                     (session.running() ? ": the run goes on" : ": the run did not end") +
                     "; only whole runs are drawn");
  }
  RunSceneResult result;
  result.frame = frame_number(session, options, run);
  const RunSetup setup = setup_of(session.info(), run);
  const Assembly robot = robot_model(setup, session.info().board_name, options.model);

  std::vector<DrivenPath> paths;
  std::vector<RobotPose> poses;
  for (const SessionReader& of : robots) {
    paths.push_back(path_until(of, result.frame));
    poses.push_back(pose_of(paths.back(), run));
  }
  const DrivenPath& driven = paths.front();
  const RobotPose& pose = poses.front();

  const RecordedTerrain ground =
      ground_at(session, result.frame, setup.experiment.map.model != "rigid", run);
  result.terrain_is_later = ground.is_later;
  const TerrainSurface surface(ground.now);
  const PictureFormat format{kFieldOfView_deg,
                             static_cast<double>(options.width_px) / options.height_px};
  const CameraOrbit& orbit = options.camera;
  const Eigen::Vector3d target = pose.body.translation() - Eigen::Vector3d(0.0, 0.0, 0.02);
  const SceneCamera camera =
      orbit.whole_bed ? camera_around(orbit, bed_points(surface, pose), format, kMargin)
                      : camera_at(orbit, target, driven.frame.yaw,
                                  [&](double x, double y) { return surface.height_m(x, y); });
  const double distance_m = (camera.location - camera.target).norm();

  PovrayJob job(picture);
  result.scene = job.scene();
  TerrainFiles files;
  files.heights = job.name_with("_ground.png");
  write_raster(job.in_the_making(files.heights), height_raster(surface));
  const GreyRaster change = change_raster(surface, *ground.before);
  if (!change.samples.empty()) {
    files.change = job.name_with("_turned.png");
    write_raster(job.in_the_making(files.change), change);
  }
  const SoilAppearance look = soil_appearance(soil_name(setup));
  std::optional<HeightTint> tint;
  if (options.tint) tint = tint_of(surface, *ground.before);
  std::string robots_text;
  for (size_t i = 0; i < robots.size(); ++i) {
    if (options.path) robots_text += path_text(paths[i].path, surface, kPathRadius * distance_m);
    robots_text += robot_text(robot, setup.experiment.vehicle.tracks, poses[i]);
  }
  job.write_scene(
      "// Made by `screed render`. Metres; x east, y north, z up.\n#version 3.7;\n"
      "global_settings { assumed_gamma 1.0 }\n" +
      camera_text(camera, format.field_of_view_deg) + (tint ? tint_text(*tint) : "") +
      (ground.particles ? spheres_text(*ground.particles, look, tint)
                        : terrain_text(surface, files, look, tint)) +
      walls_text(surface) + robots_text + (tint ? tint_legend_text(*tint, camera, format) : ""));
  if (!options.pov_only)
    result.rendered = job.render(options.width_px, options.height_px, options.progress);
  job.publish();
  return result;
}

}  // namespace screed
