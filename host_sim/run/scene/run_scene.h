// A picture of one frame of a recorded run: the ground as it lay then, the robot as it stood, its
// path.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "host_sim/core/task_progress.h"
#include "host_sim/render/scene/scene_camera.h"

namespace screed {

struct RunSceneOptions {
  std::optional<std::int64_t> frame;  ///< from 0; negative counts from the end; none: the last
  std::optional<double> at_s;         ///< in its place: the frame of this time
  CameraOrbit camera;
  std::optional<std::filesystem::path> model;  ///< the robot's URDF instead of the experiment's
  bool path = true;                            ///< draw the driven path
  bool tint = true;                            ///< heights in colour, with a colour bar
  bool pov_only = false;                       ///< only the scene
  int width_px = 1280;                         ///< 16..8000
  int height_px = 800;                         ///< 16..8000
  TaskProgress progress;                       ///< of POV-Ray; may be empty, may end it
};

struct RunSceneResult {
  std::uint64_t frame = 0;
  std::filesystem::path scene;
  bool rendered = false;  ///< false with pov_only, and when there is no povray
  /// the terrain of this frame is not in the session: that of the run's end was drawn
  bool terrain_is_later = false;
};

/// Draws frame of `run` (a run folder, or a session.h5) to `picture`, .png or .jpg; beside it stand
/// the scene and the images it needs, under its name. Files appear together, when everything is
/// done, over files of the same names. Throws InputError for what is no run, a run that did not
/// end, a frame that it has not, a model that cannot be found; RunError when something cannot be
/// written or povray fails.
RunSceneResult render_run(const std::filesystem::path& run, const std::filesystem::path& picture,
                          const RunSceneOptions& options);

}  // namespace screed
