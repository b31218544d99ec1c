// The grid world as a scene for POV-Ray: stacks of voxels shaded by height, agents as icosahedra
// (as thesis Figure 4.1). Makes the scene file, and the picture when povray is installed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/grid/grid_recording.h"

namespace screed {

/// Grids with more cells a side are not drawn.
inline constexpr int kLargestSceneSide = 256;

/// The text of a scene with the frames beside one another, from left to right; colours run over the
/// heights of the first. Throws InputError for no frame or a grid too large.
std::string scene_text(const std::vector<GridFrame>& frames);

/// Writes `picture` with the extension .pov and renders it to `picture` (.png or .jpg), `width_px`
/// wide. Returns false when there is no povray on the path: then only the scene is written. Throws
/// and reports as PovrayJob.
bool render_scene(const std::filesystem::path& picture, const std::vector<GridFrame>& frames,
                  int width_px, const TaskProgress& progress = {});

}  // namespace screed
