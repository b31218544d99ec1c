// [map] of an experiment file: the terrain before the run.
#pragma once

#include <optional>
#include <string>

namespace screed {

struct MapSection {
  std::string filename;
  double size_m = 3.0;
  std::optional<double> xy_scale;  ///< in place of size_m
  double scale_m = 0.2;
  double smoothing_m = 0.0;
  std::optional<double> max_slope_deg;
  double ramp_deg = 0.0;
  bool wrap = false;
  std::string model = "rigid";
  double particle_radius_m = 0.0125;

  bool is_soil() const { return model == "scm"; }
  bool of_particles() const { return model == "particles" || model == "static_particles"; }

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
    keys.flag("wrap", "the terrain repeats at its edges; the image must be tileable", &M::wrap);
    keys.choice("model", {"rigid", "scm", "particles", "static_particles"},
                "terrain model; scm: deformable soil, see [soil]; particles: a bed of spheres",
                &M::model);
    keys.real("particle_radius", "m", 0.001, 0.5, "model particles: radius of a particle",
              &M::particle_radius_m);
  }
};

}  // namespace screed
