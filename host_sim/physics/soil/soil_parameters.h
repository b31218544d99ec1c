// What a soil is, in the terms of terramechanics. Knows no grid and no robot.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace screed {

/// Bekker pressure-sinkage p = (k_c / b + k_phi) z^n with elastic unloading, Janosi-Hanamoto shear
/// tau = (c + p tan phi) (1 - exp(-j / K)), which on the way back does not come back: in its rate
/// form d tau = ((c + p tan phi) dj - tau |dj|) / K, in two directions.
/// Sources: M. G. Bekker, Introduction to Terrain-Vehicle Systems, 1969; Z. Janosi, B. Hanamoto,
/// 1961; P. R. Dahl, A solid friction model, 1968; J. Y. Wong, Theory of Ground Vehicles, ch. 2.
struct SoilParameters {
  std::string name = "custom";
  double k_phi = 2e6;               ///< N/m^(n+2), > 0 unless k_c is
  double k_c = 0.0;                 ///< N/m^(n+1), >= 0
  double exponent = 1.1;            ///< n, 0.1..2.5
  double cohesion_pa = 0.0;         ///< c, >= 0
  double friction_deg = 30.0;       ///< phi, 0..60
  double shear_modulus_m = 0.01;    ///< K, > 0
  double elastic_pa_per_m = 2e8;    ///< E, of unloading and reloading, > 0
  double damping_pa_s_per_m = 0.0;  ///< R, on the speed of sinking, >= 0
  double shear_damping_s = 0.002;   ///< of small shear, 0..0.1: stiffness times this is its damping
  double repose_deg = 30.0;         ///< angle of repose of loose material, 1..60
  double compaction =
      0.0;  ///< share of the sunk and dug volume that is compacted, 0..1; the rest moves aside
  double drag_depth_m = 0.0;  ///< of the layer that a slipping surface digs away, >= 0; 0: none
  double slip_sinkage =
      0.0;  ///< exponent n grows by this times the slip (Ding et al. 2011), 0..2; 0: none
};

/// Named soils: soft, viper, lete_sand, dry_sand, clay, ding_2011, gravel.
const std::vector<SoilParameters>& soil_presets();
/// Throws InputError, listing the known names.
const SoilParameters& soil_preset(std::string_view name);
/// Throws InputError that names the first parameter out of its range.
void check_soil(const SoilParameters& soil);

}  // namespace screed
