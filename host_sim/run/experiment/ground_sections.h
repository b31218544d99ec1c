// The sections of an experiment file that say what the bed is: [soil], [relief], [map],
// [particles], [physics], [trap], [raygrid]. Each lists its keys once; experiment_keys.cpp reads
// and writes them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/relief.h"

namespace screed {

// [soil] of an experiment file: the soil of the model scm, a named one and what differs from it.

struct SoilSection {
  std::string preset = "viper";
  double cell_m = 0.005;
  bool bulldozing = true;
  bool avalanches = true;
  bool follow_slopes = true;
  SoilOverrides overrides;

  template <class Keys>
  static void list(Keys& keys) {
    using S = SoilSection;
    keys.choice("preset", soil_preset_names(), "model scm: a named soil", &S::preset);
    keys.real("cell", "m", 0.001, 0.05, "model scm: side of a grid cell", &S::cell_m);
    keys.flag("bulldozing", "sunk material is pushed aside; false: compacted", &S::bulldozing);
    keys.flag("avalanches", "slopes above the angle of repose slide", &S::avalanches);
    keys.flag("follow_slopes",
              "ruts uphill and downhill are as deep as on the level; false: too deep "
              "below belts going downhill",
              &S::follow_slopes);
    for (const SoilParameterInfo& row : kSoilParameters) {
      keys.real(row.key, row.unit, row.min, row.max, row.meaning,
                [&row](S& soil) -> std::optional<double>& {
                  return soil.overrides.*row.override_member;
                });
    }
  }
};

// [relief] of an experiment file: made-up relief on top of [map], for leveling.

struct ReliefSection {
  std::optional<uint64_t> seed;  ///< left out: the experiment's
  ReliefOptions options;

  bool is_there() const {
    return options.rms_m > 0.0 || options.mounds > 0 || options.trench_depth_m > 0.0;
  }

  template <class Keys>
  static void list(Keys& keys) {
    using R = ReliefSection;
    const auto spectrum = [](const R& relief) { return relief.options.rms_m > 0.0; };
    const auto mounds = [](const R& relief) { return relief.options.mounds > 0; };
    const auto trench = [](const R& relief) { return relief.options.trench_depth_m > 0.0; };
    keys.integer("seed", "", 0, UINT32_MAX,
                 "of waves and places; left out: [experiment] seed, another bed a seed", &R::seed);
    keys.real("rms", "m", 0, 10, "waves: RMS of their heights; 0: none",
              [](R& relief) -> double& { return relief.options.rms_m; })
        .written_if(spectrum);
    keys.real("exponent", "", 0, 4,
              "waves: power spectral density of a profile falls with wave number to the power of "
              "minus this",
              [](R& relief) -> double& { return relief.options.exponent; })
        .written_if(spectrum);
    keys.real("longest_wave", "m", 0.01, 1000, "waves: the longest; none is longer than the bed",
              [](R& relief) -> double& { return relief.options.longest_wave_m; })
        .written_if(spectrum);
    keys.real("shortest_wave", "m", 0.01, 1000, "waves: the shortest",
              [](R& relief) -> double& { return relief.options.shortest_wave_m; })
        .written_if(spectrum);
    keys.integer("mounds", "", 0, 1000, "cones at random places, as of a loose deposit",
                 [](R& relief) -> uint32_t& { return relief.options.mounds; })
        .written_if(mounds);
    keys.real("mound_height", "m", 0.001, 10, "the highest mound; the lowest is half as high",
              [](R& relief) -> double& { return relief.options.mound_height_m; })
        .written_if(mounds);
    keys.real("mound_slope", "deg", 1, 60, "slope of the mounds' flanks",
              [](R& relief) -> double& { return relief.options.mound_slope_deg; })
        .written_if(mounds);
    keys.real("trench_depth", "m", 0, 10,
              "a straight trench across the bed, banks of what was dug out on both sides; 0: none",
              [](R& relief) -> double& { return relief.options.trench_depth_m; })
        .written_if(trench);
    keys.real("trench_width", "m", 0.001, 100, "width of the trench's floor",
              [](R& relief) -> double& { return relief.options.trench_width_m; })
        .written_if(trench);
    keys.real("trench_slope", "deg", 1, 60, "slope of the flanks of trench and banks",
              [](R& relief) -> double& { return relief.options.trench_slope_deg; })
        .written_if(trench);
  }
};

// [map] of an experiment file: the terrain before the run.

struct MapSection {
  std::string filename;
  double size_m = 3.0;
  std::optional<double> xy_scale;  ///< in place of size_m
  double scale_m = 0.2;
  double smoothing_m = 0.0;
  std::optional<double> max_slope_deg;
  double ramp_deg = 0.0;
  std::string edges;  ///< open, walls or wrap; empty: as edge() says
  double wall_friction = 0.3;
  std::string model = "rigid";
  double particle_radius_m = 0.0125;

  bool is_soil() const { return model == "scm"; }
  bool of_particles() const { return model == "particles" || model == "static_particles"; }

  /// Where nothing is said, the terrain ends at its edges; particles need walls to stay.
  BedEdge edge() const {
    if (edges == "wrap") return BedEdge::kWrapped;
    if (edges == "walls" || (edges.empty() && of_particles())) return BedEdge::kWalled;
    return BedEdge::kOpen;
  }
  bool wrap() const { return edge() == BedEdge::kWrapped; }

  template <class Keys>
  static void list(Keys& keys) {
    using M = MapSection;
    keys.text("filename", "a grey PNG or BMP, or heights: .asc, .npy, .tif",
              "height map; left out: level ground, or a ramp", &M::filename,
              [](const std::string& text) { return !text.empty(); });
    keys.real("size", "m", 0.1, 1000, "length of the bed's longer side", &M::size_m)
        .replaces([](M& map) { map.xy_scale.reset(); })
        .written_if([](const M& map) { return !map.xy_scale.has_value(); });
    keys.real(
        "xy_scale", "m", 1e-5, 100,
        "in place of size, or of a file's own: width of a pixel; of particles: stacks a pixel, "
        "without unit",
        &M::xy_scale);
    keys.real("scale", "m", 0.0001, 100, "of images: height of white", &M::scale_m);
    keys.real("smoothing", "m", 0, 1, "standard deviation of a Gaussian low-pass over the image",
              &M::smoothing_m);
    keys.real("max_slope", "deg", 0.1, 89, "heights are scaled down until no slope is steeper",
              &M::max_slope_deg);
    keys.real("ramp", "deg", -60, 60, "without a file: slope of the ground, rising to the east",
              &M::ramp_deg);
    keys.choice(
        "edges", {"open", "walls", "wrap"},
        "open: the terrain ends, and the run where the robot leaves it; walls: of a sandbox, "
        "the default of particles; wrap: it repeats, the image must be tileable",
        [](M& map) -> std::string& {
          if (map.edges.empty()) map.edges = map.edge() == BedEdge::kWalled ? "walls" : "open";
          return map.edges;
        });
    keys.real("wall_friction", "", 0, 5, "edges = walls: Coulomb friction of robots on the walls",
              &M::wall_friction);
    keys.choice("model", {"rigid", "scm", "particles", "static_particles"},
                "terrain model; scm: deformable soil, see [soil]; particles: a bed of spheres",
                &M::model);
    keys.real("particle_radius", "m", 0.001, 0.5, "model particles: radius of a particle",
              &M::particle_radius_m);
  }
};

// [particles] of an experiment file: what the particles of the models particles and
// static_particles are, and how many lie there.

struct ParticlesSection {
  double depth_m = 0.1;
  double density_kg_per_m3 = 2600.0;
  double friction = 0.6;
  double rolling = 0.1;

  template <class Keys>
  static void list(Keys& keys) {
    using P = ParticlesSection;
    keys.real("depth", "m", 0, 10,
              "depth of the bed below the image's black; on level ground its depth", &P::depth_m);
    keys.real("density", "kg/m^3", 10, 20000, "density of a particle", &P::density_kg_per_m3);
    keys.real("friction", "", 0, 5, "Coulomb friction between particles, and on the walls",
              &P::friction);
    keys.real("rolling", "", 0, 5, "resistance to rolling, as a share of the radius", &P::rolling);
  }
};

// [physics] of an experiment file.

struct PhysicsSection {
  double step_s = 0.001;

  template <class Keys>
  static void list(Keys& keys) {
    keys.real("step", "s", 1e-5, 0.01, "integration step; divides 0.01 s", &PhysicsSection::step_s);
  }
};

// [trap] of an experiment file: a place that the robot does not get out of, in front of its start.

/// The names of [trap] kind; the first is that of no trap (placement.cpp).
std::vector<std::string> trap_kinds();

struct TrapSection {
  std::string kind = "none";
  double distance_m = 0.5;
  double size = 0.1;  ///< m; of a slope degrees

  template <class Keys>
  static void list(Keys& keys) {
    using T = TrapSection;
    keys.choice("kind", trap_kinds(),
                "obstacle that robots get stuck at: a wall, a slope or a trench all round the "
                "start; a hump between the tracks, ruts under them, in front of it",
                &T::kind);
    const auto is_there = [](const T& trap) { return trap.kind != "none"; };
    keys.real("distance", "m", -10, 10,
              "distance from the start to the obstacle, 0.5 if left out; ruts may begin behind the "
              "start",
              &T::distance_m)
        .written_if(is_there);
    keys.real("size", "m or deg", 0.001, 60,
              "height or depth in m, 0.1 if left out; of a slope its angle in degrees", &T::size)
        .written_if(is_there);
  }
};

// [raygrid] of an experiment file: how the height map of particles is read.

struct RaygridSection {
  double resolution_per_m = 200.0;

  template <class Keys>
  static void list(Keys& keys) {
    keys.real("resolution", "1/m", 2, 2000,
              "model particles: rays a metre that read the height map",
              &RaygridSection::resolution_per_m);
  }
};

}  // namespace screed
