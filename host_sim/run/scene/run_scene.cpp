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
#include "host_sim/render/scene/terrain_scene.h"
#include "host_sim/run/experiment/run_setup.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {
namespace {

constexpr double kFieldOfView_deg = 40.0;
constexpr double kPathRadius =
    0.0022;  // of the line that shows the way, to the distance it is seen from

std::filesystem::path session_of(const std::filesystem::path& run) {
  std::error_code error;
  if (!std::filesystem::is_directory(run, error)) return run;
  std::filesystem::path file = run / "session.h5";
  if (!std::filesystem::exists(file, error)) {
    throw InputError(run.string() + ": is not the folder of a run: there is no session.h5 in it");
  }
  return file;
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
  constexpr std::uint64_t kBlockRows = 1024;
  constexpr double kPathStep_m = 0.01;
  DrivenPath driven;
  std::vector<SimFrame> frames;
  const double dt = 1.0 / session.info().tick_rate_hz;
  for (std::uint64_t first = 0; first <= last; first += frames.size()) {
    frames.resize(std::min(kBlockRows, last + 1 - first));
    session.read(first, std::span(frames));
    for (const SimFrame& frame : frames) {
      driven.travel_m[0] += std::isfinite(frame.track_left) ? frame.track_left * dt : 0.0;
      driven.travel_m[1] += std::isfinite(frame.track_right) ? frame.track_right * dt : 0.0;
      const Eigen::Vector2d at(frame.x, frame.y);
      if (driven.path.empty() || (at - driven.path.back()).norm() >= kPathStep_m)
        driven.path.push_back(at);
    }
  }
  driven.frame = frames.back();
  driven.path.emplace_back(driven.frame.x, driven.frame.y);
  return driven;
}

std::uint64_t frame_number(const SessionReader& session, const RunSceneOptions& options,
                           const std::filesystem::path& run) {
  const auto count = static_cast<std::int64_t>(session.frames());
  if (count == 0) throw InputError(run.string() + ": no frame was recorded");
  const std::int64_t asked = options.frame.value_or(-1);
  const std::int64_t frame = asked < 0 ? count + asked : asked;
  if (frame < 0 || frame >= count) {
    throw InputError("frame = " + std::to_string(asked) + "; " + run.string() +
                     " has frames 0 to " + std::to_string(count - 1));
  }
  return static_cast<std::uint64_t>(frame);
}

struct RecordedTerrain {
  HeightMap now;
  std::optional<HeightMap> before;
  bool is_later = false;
};

RecordedTerrain ground_at(const SessionReader& session, std::uint64_t frame, bool soft,
                          const std::filesystem::path& run) {
  RecordedTerrain ground;
  ground.before = session.terrain_before();
  if (!ground.before) throw InputError(run.string() + ": the session holds no height map");
  if (session.has_heights()) {
    ground.now = session.heights_after(frame + 1);
    return ground;
  }
  const auto after = session.terrain_after();
  if (frame == 0 || !soft || !after) {
    ground.now = *ground.before;
  } else {
    ground.now = *after;
    ground.is_later = frame + 1 < session.frames();
  }
  return ground;
}

void write_raster(const std::filesystem::path& file, const GreyRaster& raster) {
  write_grey16_png(file, raster.width, raster.height, raster.samples);
}

}  // namespace

RunSceneResult render_run(const std::filesystem::path& run, const std::filesystem::path& picture,
                          const RunSceneOptions& options) {
  const SessionReader session(session_of(run));
  if (!session.complete()) {
    throw InputError(run.string() + ": the run did not end; only whole runs are drawn");
  }
  RunSceneResult result;
  result.frame = frame_number(session, options, run);
  const RunSetup setup = setup_of(session.info(), run);
  const Assembly robot = robot_model(setup, session.info().board_name, options.model);

  const DrivenPath driven = path_until(session, result.frame);
  RobotPose pose;
  pose.body.linear() = rotation_from({driven.frame.roll, driven.frame.pitch, driven.frame.yaw});
  pose.body.translation() << driven.frame.x, driven.frame.y, driven.frame.z;
  pose.travel_m = driven.travel_m;
  if (!pose.body.matrix().allFinite()) {
    throw InputError(run.string() + ": frame " + std::to_string(result.frame) +
                     " has no pose of the robot");
  }

  const RecordedTerrain ground =
      ground_at(session, result.frame, setup.experiment.map.model != "rigid", run);
  result.terrain_is_later = ground.is_later;
  const TerrainSurface surface(ground.now);
  CameraOrbit orbit = options.camera;
  Eigen::Vector3d target = pose.body.translation() - Eigen::Vector3d(0.0, 0.0, 0.02);
  double heading = driven.frame.yaw;
  if (orbit.whole_bed) {
    target << surface.x_min() + surface.width_m() / 2, surface.y_min() + surface.depth_m() / 2,
        0.5 * (surface.lowest_m() + surface.highest_m());
    heading = 0.0;
    orbit.distance_m = 1.75 * std::max(surface.width_m(), surface.depth_m());
  }
  const SceneCamera camera =
      camera_at(orbit, target, heading, [&](double x, double y) { return surface.height_m(x, y); });

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
  job.write_scene(
      "// Made by `screed render`. Metres; x east, y north, z up.\n#version 3.7;\n"
      "global_settings { assumed_gamma 1.0 }\n" +
      camera_text(camera, kFieldOfView_deg) +
      terrain_text(surface, files, soil_appearance(soil_name(setup))) +
      (options.path ? path_text(driven.path, surface, kPathRadius * orbit.distance_m) : "") +
      robot_text(robot, setup.experiment.vehicle.tracks, pose));
  if (!options.pov_only)
    result.rendered = job.render(options.width_px, options.height_px, options.progress);
  job.publish();
  return result;
}

}  // namespace screed
