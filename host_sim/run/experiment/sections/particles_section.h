// [particles] of an experiment file: what the particles of the models particles and
// static_particles are, and how many lie there.
#pragma once

namespace screed {

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

}  // namespace screed
