// A bed of particles for tests, and any bed as one hash.
#pragma once

#include <algorithm>
#include <string>

#include "host_sim/core/content_hash.h"
#include "host_sim/physics/particles/bed_layout.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// 30 x 30 stacks of 5 to 9 spheres as laid, all awake: several groups of particles, so that
/// contacts cross from one to another.
inline ParticleBed fresh_heap(const ParticleOptions& options, bool periodic) {
  constexpr double kSize = 0.75;
  const HeightField top = HeightField::from_function(
      31, 31, kSize / 30.0, periodic,
      [](double x, double y) { return 0.13 + 0.1 * std::max(0.0, 1.0 - 8.0 * (x * x + y * y)); });
  const double radius = options.material.radius_m;
  const BedExtent extent = bed_extent(top, radius);
  return {lay_spheres(stack_counts(top, extent, radius), extent, radius, 1), extent, 0.4, options};
}

/// Everything that a bed is, to the last bit.
inline std::string fingerprint(const ParticleBed& bed) {
  ContentHash hash;
  for (size_t i = 0; i < bed.size(); ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      hash.add(bed.position(i)[axis]);
      hash.add(bed.velocity(i)[axis]);
      hash.add(bed.angular_velocity(i)[axis]);
    }
    hash.add(bed.awake(i));
  }
  const HeightField& surface = bed.surface();
  for (int iy = 0; iy < surface.ny(); ++iy) {
    for (int ix = 0; ix < surface.nx(); ++ix) hash.add(surface.node(ix, iy));
  }
  return hash.hex();
}

}  // namespace screed
