// [raygrid] of an experiment file: how the height map of particles is read.
#pragma once

namespace screed {

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
