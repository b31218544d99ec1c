// Rigid ground, soil or particles.
#include "host_sim/physics/world/terrain_factory.h"

#include <utility>

#include "host_sim/physics/terrain/rigid_terrain.h"

namespace screed {

std::unique_ptr<Terrain> build_terrain(HeightField surface, const TerrainOptions& options) {
  if (options.particles.has_value()) {
    return std::make_unique<ParticleBed>(surface, *options.particles, options.progress);
  }
  if (options.soil.has_value()) {
    return std::make_unique<SoilBed>(std::move(surface), *options.soil, options.soil_options);
  }
  return std::make_unique<RigidTerrain>(std::move(surface));
}

}  // namespace screed
