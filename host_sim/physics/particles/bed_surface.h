// The height map of a bed of particles: rays from above, cast again only where particles have
// moved.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/physics/particles/bed_layout.h"
#include "host_sim/physics/particles/bed_particles.h"
#include "host_sim/physics/particles/sphere_grid.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

class BedSurface {
 public:
  BedSurface(const BedExtent& extent, double ray_spacing_m, double radius_m,
             const SphereGrid& grid);

  /// A particle in this cube of the grid has moved, or is about to leave it.
  void mark(const SphereGrid& grid, int32_t cell);
  /// The map as of the last cast().
  const HeightField& field() const { return field_; }
  /// Casts the rays again round all that was marked.
  void cast(const SphereGrid& grid, const BedParticles& particles);

 private:
  void cast_rays(const SphereGrid& grid, const BedParticles& particles, int column_x, int column_y);

  BedExtent extent_;
  double radius_m_;
  HeightField field_;
  // Columns of the grid.
  std::vector<uint8_t> stale_;
  std::vector<int32_t> stale_columns_;
  std::vector<uint8_t> to_cast_;
  std::vector<int32_t> cast_columns_;
  std::vector<int> rays_x_;  // the first ray in each column of the grid, and one more
  std::vector<int> rays_y_;
};

}  // namespace screed
