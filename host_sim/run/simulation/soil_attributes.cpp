// Soil parameters as names, units and numbers.
#include "host_sim/run/simulation/soil_attributes.h"

namespace screed {

std::vector<SoilAttribute> attributes_of(const SoilParameters& soil) {
  return {{"k_phi", "N/m^(n+2)", soil.k_phi},
          {"k_c", "N/m^(n+1)", soil.k_c},
          {"n", "", soil.exponent},
          {"c", "Pa", soil.cohesion_pa},
          {"phi", "deg", soil.friction_deg},
          {"K", "m", soil.shear_modulus_m},
          {"E", "Pa/m", soil.elastic_pa_per_m},
          {"R", "Pa s/m", soil.damping_pa_s_per_m},
          {"shear_damping", "s", soil.shear_damping_s},
          {"repose", "deg", soil.repose_deg},
          {"compaction", "", soil.compaction},
          {"drag_depth", "m", soil.drag_depth_m},
          {"slip_sinkage", "", soil.slip_sinkage}};
}

}  // namespace screed
