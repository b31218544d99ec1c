// What a soil is, in the terms of terramechanics: one table of its parameters, one of named soils.
// Knows no grid and no robot.
//
// The table of parameters is a macro so that the struct, its defaults, the range check, the keys of
// experiment files, the options of `screed soil` and the attributes of recorded runs are made from
// the same lines. A new parameter is a row here and its use. The named soils stand in
// soil_parameters.cpp, a row each.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace screed {

// member: of the structs, and its key in JSON; key: symbol in experiment files, recorded runs and
// messages; option: of `screed soil`.
// clang-format off
//  member              key              option             unit         min   max   default  meaning
#define SCREED_SOIL_PARAMETERS(X) \
  X(k_phi,              "k_phi",         "--k-phi",         "N/m^(n+2)", 0.0,  1e12, 2e6, \
    "Bekker's frictional modulus; left out: the preset's") \
  X(k_c,                "k_c",           "--k-c",           "N/m^(n+1)", 0.0,  1e12, 0.0, \
    "Bekker's cohesive modulus") \
  X(exponent,           "n",             "--exponent",      "",          0.1,  2.5,  1.1, \
    "Bekker's exponent of sinkage") \
  X(cohesion_pa,        "c",             "--cohesion",      "Pa",        0.0,  1e6,  0.0,   "cohesion") \
  X(friction_deg,       "phi",           "--friction",      "deg",       0.0,  60.0, 30.0, \
    "angle of internal friction") \
  X(shear_modulus_m,    "K",             "--shear-modulus", "m",         1e-5, 1.0,  0.01, \
    "Janosi-Hanamoto shear modulus") \
  X(elastic_pa_per_m,   "E",             "--elastic",       "Pa/m",      1e5,  1e12, 2e8,   "stiffness of unloading") \
  X(damping_pa_s_per_m, "R",             "--damping",       "Pa s/m",    0.0,  1e9,  0.0,   "damping of sinking") \
  X(shear_damping_s,    "shear_damping", "--shear-damping", "s",         0.0,  0.1,  0.002, \
    "damping of small shear, over its stiffness; 0.002 by default") \
  X(repose_deg,         "repose",        "--repose",        "deg",       1.0,  60.0, 30.0,  "angle of repose") \
  X(compaction,         "compaction",    "--compaction",    "",          0.0,  1.0,  0.0, \
    "share of the sunk volume that is compacted") \
  X(compaction_depth_m, "compaction_depth", "--compaction-depth", "m",   0.0,  1.0,  0.0, \
    "how much a place may lose by compaction in all; 0: any") \
  X(slip_layer_m,       "slip_layer",    "--slip-layer",    "m",         0.0,  0.1,  0.0, \
    "thickness of the layer that goes along with a slipping surface") \
  X(slip_carry,         "slip_carry",    "--slip-carry",    "",          0.0,  1.0,  0.0, \
    "share of the surface's slip with which it goes along") \
  X(slip_bearing,       "slip_bearing",  "--slip-bearing",  "",          0.0,  1.0,  1.0, \
    "share of its bearing that soil keeps below a surface that slides over it; 1: all") \
  X(front_angle,        "c1",            "--c1",            "",          0.0,  0.9,  0.0, \
    "angle of a wheel's greatest stress over its entry angle; 0: below the axle") \
  X(front_angle_braked, "c2_braked",     "--c2-braked",     "",          -0.9, 0.9,  0.0, \
    "growth of c1 with slip, braked") \
  X(exit_angle,         "c3",            "--c3",            "",          0.0,  0.9,  0.0, \
    "angle at which a wheel leaves the soil, over its entry angle") \
  X(density_kg_per_m3,  "density",       "--density",       "kg/m^3",    0.0,  5e3,  0.0, \
    "density, for the resistance of what is pushed ahead; 0: no such resistance")
// clang-format on

/// Bekker pressure-sinkage p = (k_c / b + k_phi) z^n with elastic unloading, Janosi-Hanamoto shear
/// tau = (c + p tan phi) (1 - exp(-j / K)), j along the running surface (shear_field.h). What
/// slides over soil is borne by down to slip_bearing times that pressure (soil_laws.h). Below a
/// wheel the greatest stress is at c1 times the entry angle, braked at (c1 + c2_braked |s|) times
/// it, and contact ends at -c3 times it (soil_laws.h). What is pushed ahead resists by its density
/// (soil_laws.h).
/// Sources: M. G. Bekker, Introduction to Terrain-Vehicle Systems, 1969; Z. Janosi, B. Hanamoto,
/// 1961; J. Y. Wong, A. R. Reece, Journal of Terramechanics 4, 1967; J. Y. Wong, Theory of Ground
/// Vehicles, ch. 2.
struct SoilParameters {
  std::string name = "custom";
#define SCREED_FIELD(member, key, option, unit, min, max, value, meaning) double member = (value);
  SCREED_SOIL_PARAMETERS(SCREED_FIELD)
#undef SCREED_FIELD
};

/// What stands in place of a soil's own parameters.
struct SoilOverrides {
#define SCREED_FIELD(member, key, option, unit, min, max, value, meaning) \
  std::optional<double> member;
  SCREED_SOIL_PARAMETERS(SCREED_FIELD)
#undef SCREED_FIELD

  bool empty() const;
  void apply_to(SoilParameters& soil) const;
};

/// A row of the table.
struct SoilParameterInfo {
  const char* member_name;
  const char* key;
  const char* option;
  const char* unit;  ///< "": none
  double min;
  double max;
  double default_value;
  const char* meaning;
  double SoilParameters::*member;
  std::optional<double> SoilOverrides::*override_member;
};
inline constexpr SoilParameterInfo kSoilParameters[] = {
#define SCREED_INFO(member, key, option, unit, min, max, value, meaning) \
  {#member,                                                              \
   key,                                                                  \
   option,                                                               \
   unit,                                                                 \
   min,                                                                  \
   max,                                                                  \
   value,                                                                \
   meaning,                                                              \
   &SoilParameters::member,                                              \
   &SoilOverrides::member},
    SCREED_SOIL_PARAMETERS(SCREED_INFO)
#undef SCREED_INFO
};

/// Two tones that a soil varies between in pictures, sRGB, components 0..1.
struct SoilTones {
  std::array<double, 3> light;
  std::array<double, 3> dark;
};

/// How well it is known what slip does to a named soil.
struct SlipEvidence {
  std::string_view bearing;             ///< where slip_bearing comes from
  std::array<double, 2> bearing_range;  ///< in which it lies
  std::string_view carry = "assumed";   ///< and slip_carry
  std::array<double, 2> carry_range = {0.0, 1.0};
};

/// A named soil. Its look stands beside its numbers, since both describe the same material, and so
/// that a named soil is one row; physics does not read it.
struct SoilPreset {
  SoilParameters soil;
  SoilTones tones;
  SlipEvidence slip;
};

const std::vector<SoilPreset>& soil_presets();
std::vector<std::string> soil_preset_names();
/// Throws InputError, listing the known names.
const SoilParameters& soil_preset(std::string_view name);
/// Null for a name that is not known.
const SlipEvidence* slip_evidence(std::string_view name);
/// The look of a named soil; of an unknown one that of loam.
const SoilTones& soil_tones(std::string_view name);

/// Throws InputError that names the first parameter out of its range.
void check_soil(const SoilParameters& soil);

}  // namespace screed
