// The pictures of a run: the terrain before, after it with the driven path, and what has changed.
#pragma once

#include <filesystem>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/render/picture/robot_shape.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// The terrain before and after a run, as TerrainMeasure::surface() gives it.
struct RunSurfaces {
  HeightField before;
  HeightField after;
};

/// Writes terrain_before.png and terrain_after.png into the folder, both in the same colours for
/// the same height, and terrain_change.png where the terrain is deformable. `path`: its states are
/// those of the leveling algorithm (LevelingState). `shape`: the robot's. Throws RunError when a
/// file cannot be written.
void write_run_pictures(const std::filesystem::path& folder, const Experiment& experiment,
                        const RunSurfaces& terrain, const Environment& plant,
                        std::vector<PathPoint> path, const RobotShape& shape);

}  // namespace screed
