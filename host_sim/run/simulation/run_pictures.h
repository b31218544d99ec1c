// The pictures of a run: the terrain before, and after it with the driven path.
#pragma once

#include <filesystem>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// Writes terrain_before.png and terrain_after.png into the folder. `path`: its states are those of
/// the leveling algorithm (LevelingState). Throws RunError when a file cannot be written.
void write_run_pictures(const std::filesystem::path& folder, const Experiment& experiment,
                        const HeightField& before, const Environment& plant,
                        std::vector<PathPoint> path);

}  // namespace screed
