// What the stand-in's closed forms do not say by themselves: five numbers, the same for all soils,
// chosen on drives in the physics (docs/standin.md).
#pragma once

namespace screed {

struct BeltFit {
  /// Strength across a belt over that along it.
  double sideways = 2.0;
  /// Resistance to rolling over load.
  double rolling = 0.02;
  /// Stiffness of unloading, over the soil's mean stiffness at 2 kPa, where the soil's own E is
  /// more: so that one compacted cell does not hold a belt up.
  double unloading = 10.0;
  /// Of the volume that slip digs, over that of the soil's law.
  double digging = 1.15;
  /// Of the way that a slope carries what is dug, over that of the soil's law.
  double downhill = 0.7;
};

}  // namespace screed
