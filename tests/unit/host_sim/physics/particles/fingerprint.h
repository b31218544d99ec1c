// A bed of particles as one hash.
#pragma once

#include <string>

#include "host_sim/core/content_hash.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

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
