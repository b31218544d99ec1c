// Which terrain a plant is given: the one place that knows all kinds.
#pragma once

#include <memory>
#include <optional>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/physics/terrain/terrain.h"

namespace screed {

/// Rigid ground, unless one of these is given.
struct TerrainOptions {
  std::optional<SoilParameters> soil;  ///< deformable soil
  SoilOptions soil_options;
  std::optional<ParticleOptions> particles;  ///< spheres, as high as the surface; not with soil
  TaskProgress progress;                     ///< of building; may be empty
};

/// Terrain of the kind that the options name, with this surface. Throws InputError as SoilBed and
/// ParticleBed do.
std::unique_ptr<Terrain> build_terrain(HeightField surface, const TerrainOptions& options);

}  // namespace screed
