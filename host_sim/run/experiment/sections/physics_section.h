// [physics] of an experiment file.
#pragma once

namespace screed {

struct PhysicsSection {
  double step_s = 0.001;

  template <class Keys>
  static void list(Keys& keys) {
    keys.real("step", "s", 1e-5, 0.01, "integration step; divides 0.01 s", &PhysicsSection::step_s);
  }
};

}  // namespace screed
