// [map] of an experiment file: the terrain before the run.
#pragma once

#include <optional>
#include <string>

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

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
    keys.text("filename", "a grey PNG or BMP file", "height map; left out: level ground, or a ramp",
              &M::filename, [](const std::string& text) { return !text.empty(); });
    keys.real("size", "m", 0.1, 1000, "length of the bed's longer side", &M::size_m)
        .replaces([](M& map) { map.xy_scale.reset(); })
        .written_if([](const M& map) { return !map.xy_scale.has_value(); });
    keys.real("xy_scale", "m", 1e-5, 100,
              "in place of size: width of a pixel; of particles: stacks a pixel, without unit",
              &M::xy_scale);
    keys.real("scale", "m", 0.0001, 100, "height of white", &M::scale_m);
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

}  // namespace screed
