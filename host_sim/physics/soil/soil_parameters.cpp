// Named soils and their limits.
#include "host_sim/physics/soil/soil_parameters.h"

#include <cmath>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

SoilParameters soil(const char* name, double k_phi, double k_c, double n, double c, double phi,
                    double shear, double elastic) {
  SoilParameters s;
  s.name = name;
  s.k_phi = k_phi;
  s.k_c = k_c;
  s.exponent = n;
  s.cohesion_pa = c;
  s.friction_deg = phi;
  s.shear_modulus_m = shear;
  s.elastic_pa_per_m = elastic;
  // Loose, dry material lies at its friction angle; what sticks together stands steeper.
  s.repose_deg = c > 2e3 ? 45.0 : phi;
  return s;
}

/// What a bed of particles of 15 mm is like (docs/soil.md, Digging).
SoilParameters gravel() {
  SoilParameters s = soil("gravel", 867e3, 0.0, 0.9, 0.0, 25.0, 0.0023, 2e6);
  s.repose_deg = 34.4;
  s.compaction = 0.45;
  s.drag_depth_m = 0.0029;
  return s;
}

}  // namespace

const std::vector<SoilParameters>& soil_presets() {
  // soft and viper: loose sands of rover studies, origin not verified; lete_sand, dry_sand, clay:
  // Wong, Theory of Ground Vehicles, table 2.3; ding_2011: the simulant of Ding et al., Journal of
  // Terramechanics 48(1), 2011. The stiffness of unloading is not in these sources: chosen so that
  // the elastic part of the sinkage stays small.
  static const std::vector<SoilParameters> presets = {
      soil("soft", 0.2e6, 0.0, 1.1, 0.0, 30.0, 0.010, 4e7),
      soil("viper", 2e6, 0.0, 1.1, 0.0, 30.0, 0.010, 2e8),
      soil("lete_sand", 5301e3, 102e3, 0.793, 1.3e3, 31.1, 0.012, 4e8),
      soil("dry_sand", 1528.43e3, 0.99e3, 1.1, 1.04e3, 28.0, 0.025, 2e8),
      soil("clay", 692.15e3, 13.19e3, 0.5, 4.14e3, 13.0, 0.010, 2e8),
      soil("ding_2011", 2407.4e3, 15.6e3, 1.1, 250.0, 31.9, 0.011, 2e8),
      gravel(),
  };
  return presets;
}

const SoilParameters& soil_preset(std::string_view name) {
  std::string known;
  for (const SoilParameters& preset : soil_presets()) {
    if (preset.name == name) return preset;
    known += (known.empty() ? "" : ", ") + preset.name;
  }
  throw InputError("unknown soil '" + std::string(name) + "'; known are " + known);
}

void check_soil(const SoilParameters& s) {
  const auto require = [](const char* name, double value, double min, double max) {
    if (!(value >= min && value <= max)) {
      throw InputError(std::string("soil: ") + name + " = " + std::to_string(value) +
                       "; allowed is " + std::to_string(min) + " to " + std::to_string(max));
    }
  };
  require("k_phi", s.k_phi, 0.0, 1e12);
  require("k_c", s.k_c, 0.0, 1e12);
  require("k_phi + k_c", s.k_phi + s.k_c, 1.0, 2e12);
  require("n", s.exponent, 0.1, 2.5);
  require("c", s.cohesion_pa, 0.0, 1e7);
  require("phi", s.friction_deg, 0.0, 60.0);
  require("K", s.shear_modulus_m, 1e-5, 1.0);
  require("E", s.elastic_pa_per_m, 1e4, 1e12);
  require("R", s.damping_pa_s_per_m, 0.0, 1e9);
  require("shear_damping", s.shear_damping_s, 0.0, 0.1);
  require("repose", s.repose_deg, 1.0, 60.0);
  require("compaction", s.compaction, 0.0, 1.0);
  require("drag_depth", s.drag_depth_m, 0.0, 1.0);
  require("slip_sinkage", s.slip_sinkage, 0.0, 2.0);
}

}  // namespace screed
