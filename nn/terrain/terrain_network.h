// A trained network of either kind (flux_network.h, window_network.h) as what a robot on wheels
// does to the ground below it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "nn/terrain/stride.h"

namespace screed::nn {

/// Changes the ground by a stride of one robot; called stride after stride.
using GroundChange = std::function<void(HeightField& ground, const Stride& stride)>;

struct TerrainNetwork {
  std::string kind;  ///< "fluxes" or "window"
  /// For a robot that begins to drive.
  std::function<GroundChange(const Assembly& robot)> change;
};

/// Throws InputError, naming the file, when it holds neither.
TerrainNetwork read_terrain_network(const std::filesystem::path& file);

}  // namespace screed::nn
