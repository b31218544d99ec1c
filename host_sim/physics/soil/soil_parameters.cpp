// Named soils, and what is made from the table of parameters.
#include "host_sim/physics/soil/soil_parameters.h"

#include <algorithm>

#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
#include "host_sim/core/name_list.h"

namespace screed {
namespace {

/// Whether no two rows share a key, an option or a member, and defaults lie in their ranges.
constexpr bool table_is_sound() {
  for (const SoilParameterInfo& row : kSoilParameters) {
    if (!(row.min <= row.default_value && row.default_value <= row.max)) return false;
    for (const SoilParameterInfo& other : kSoilParameters) {
      if (&row == &other) continue;
      if (std::string_view(row.key) == other.key || std::string_view(row.option) == other.option)
        return false;
    }
  }
  return true;
}
static_assert(table_is_sound(),
              "SCREED_SOIL_PARAMETERS: a key or option stands twice, or a "
              "default is out of its range");

constexpr SoilTones kLoam{{0.66, 0.54, 0.41}, {0.42, 0.32, 0.23}};
constexpr SoilTones kSand{{0.85, 0.74, 0.55}, {0.66, 0.54, 0.37}};
constexpr SoilTones kClay{{0.66, 0.43, 0.31}, {0.42, 0.25, 0.18}};
constexpr SoilTones kSimulant{{0.62, 0.60, 0.57}, {0.42, 0.41, 0.39}};
constexpr SoilTones kGravel{{0.66, 0.64, 0.60}, {0.38, 0.37, 0.35}};

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

/// Of gravel, fitted; assumed of other soils, where nobody has measured it.
constexpr double kCarry = 0.66;

// slip_bearing where no test has slipped. Of loose sand as of cmu_2022, between ding_2011's and
// none: a long belt sinks four times as deep at slip 1 as at rest (M. G. Lyasko, Slip sinkage
// effect in soil-vehicle mechanics, Journal of Terramechanics 47(1), 2010); 0.28 gives three times
// where n is 1.1. Where cohesion alone bears what stands there, the soil does not flow: a footing
// on it bears 5 c to 33 c, from clay to sand (A. S. Vesic, Journal of the Soil Mechanics and
// Foundations Division 99(SM1), 1973), 20 kPa and more below robots of 1 to 2 kPa.
constexpr double kLooseBearing = 0.28;
constexpr SlipEvidence kLoose{"assumed, as cmu_2022", {0.06, 1.0}};
constexpr SlipEvidence kCohesive{"assumed, cohesion bears", {0.28, 1.0}};

SoilParameters assumed(SoilParameters s, double slip_bearing) {
  s.slip_bearing = slip_bearing;
  s.slip_carry = kCarry;
  return s;
}

/// The simulant of Ding et al., 2011. Published: k_phi, k_c, c, phi. E as for the other sands. c1
/// and c3 assumed, near the published ones of their wheels. Fitted to the smooth wheel
/// (docs/studies/soil.md): n, K, slip_bearing.
SoilParameters ding_2011() {
  SoilParameters s = soil("ding_2011", 2407.4e3, 15.6e3, 0.943, 250.0, 31.9, 0.0039, 1e8);
  s.slip_bearing = 0.064;
  s.slip_carry = kCarry;
  s.front_angle = 0.3;
  s.exit_angle = 0.3;
  return s;
}

/// The sand of Carnegie Mellon University's wheel tests, 2022. Published: k_phi, n, phi, density.
/// c1 assumed, as above. Fitted to the smooth wheel at slip angle 0, its transients and its steady
/// states (docs/studies/soil.md): K, slip_bearing, c2_braked, c3.
SoilParameters cmu_2022() {
  SoilParameters s = soil("cmu_2022", 8e6, 0.0, 1.46, 0.0, 29.0, 0.010, 1e8);
  s.slip_bearing = 0.283;
  s.slip_carry = kCarry;
  s.front_angle = 0.25;
  s.front_angle_braked = 0.515;
  s.exit_angle = 0.652;
  s.density_kg_per_m3 = 1330.0;
  return s;
}

/// What a bed of particles of 15 mm is like (docs/studies/soil.md, Digging).
SoilParameters gravel() {
  SoilParameters s = soil("gravel", 827e3, 0.0, 0.9, 0.0, 22.8, 0.0017, 2e6);
  s.repose_deg = 34.4;
  s.compaction = 0.37;
  s.compaction_depth_m = 0.003;
  s.slip_layer_m = 0.002;
  s.slip_carry = kCarry;
  return s;
}

const SoilPreset* preset_named(std::string_view name) {
  const auto found =
      std::find_if(soil_presets().begin(), soil_presets().end(),
                   [&](const SoilPreset& preset) { return preset.soil.name == name; });
  return found == soil_presets().end() ? nullptr : &*found;
}

}  // namespace

const std::vector<SoilPreset>& soil_presets() {
  // soft and viper: loose sands of rover studies, origin not verified; lete_sand, dry_sand, clay:
  // Wong, Theory of Ground Vehicles, table 2.3; ding_2011: the simulant of Ding et al., Journal of
  // Terramechanics 48(1), 2011; cmu_2022: C. Pavlov, A. Johnson, 2022. The stiffness of unloading
  // is not in these sources: docs/studies/soil.md has its order of magnitude.
  static const std::vector<SoilPreset> presets = {
      {assumed(soil("soft", 0.2e6, 0.0, 1.1, 0.0, 30.0, 0.010, 4e7), kLooseBearing), kLoam, kLoose},
      {assumed(soil("viper", 2e6, 0.0, 1.1, 0.0, 30.0, 0.010, 1e8), kLooseBearing), kLoam, kLoose},
      {assumed(soil("lete_sand", 5301e3, 102e3, 0.793, 1.3e3, 31.1, 0.012, 1e8), 1.0), kSand,
       kCohesive},
      {assumed(soil("dry_sand", 1528.43e3, 0.99e3, 1.1, 1.04e3, 28.0, 0.025, 1e8), 1.0), kSand,
       kCohesive},
      {assumed(soil("clay", 692.15e3, 13.19e3, 0.5, 4.14e3, 13.0, 0.010, 4e7), 1.0), kClay,
       kCohesive},
      {ding_2011(), kSimulant, {"fitted to wheels", {0.0, 0.13}}},
      {cmu_2022(), kSand, {"fitted to wheels", {0.26, 0.31}}},
      {gravel(),
       kGravel,
       {"fitted to particles as a layer", {1.0, 1.0}, "fitted to particles", {0.66, 0.66}}},
  };
  return presets;
}

std::vector<std::string> soil_preset_names() {
  std::vector<std::string> names;
  for (const SoilPreset& preset : soil_presets()) names.push_back(preset.soil.name);
  return names;
}

const SoilParameters& soil_preset(std::string_view name) {
  if (const SoilPreset* const preset = preset_named(name)) return preset->soil;
  throw InputError("unknown soil '" + std::string(name) + "'; known are " +
                   name_list(soil_preset_names()));
}

const SlipEvidence* slip_evidence(std::string_view name) {
  const SoilPreset* const preset = preset_named(name);
  return preset != nullptr ? &preset->slip : nullptr;
}

const SoilTones& soil_tones(std::string_view name) {
  const SoilPreset* const preset = preset_named(name);
  return preset != nullptr ? preset->tones : kLoam;
}

bool SoilOverrides::empty() const {
  return std::none_of(std::begin(kSoilParameters), std::end(kSoilParameters),
                      [this](const SoilParameterInfo& parameter) {
                        return (this->*parameter.override_member).has_value();
                      });
}

void SoilOverrides::apply_to(SoilParameters& soil) const {
  for (const SoilParameterInfo& parameter : kSoilParameters) {
    const std::optional<double>& value = this->*parameter.override_member;
    if (value.has_value()) soil.*parameter.member = *value;
  }
}

void check_soil(const SoilParameters& soil) {
  const auto require = [](const char* name, double value, double min, double max) {
    if (value >= min && value <= max) return;
    throw InputError(std::string("[soil] ") + name + " = " + shortest(value) + "; allowed is " +
                     shortest(min) + " to " + shortest(max));
  };
  for (const SoilParameterInfo& parameter : kSoilParameters)
    require(parameter.key, soil.*parameter.member, parameter.min, parameter.max);
  // A soil that carries nothing.
  require("k_phi + [soil] k_c", soil.k_phi + soil.k_c, 1.0, 2e12);
}

}  // namespace screed
