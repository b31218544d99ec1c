// What the stand-in's closed forms do not say by themselves: four numbers, the same for all soils,
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
  /// Of the volume that slip digs.
  double digging = 0.92;
};

}  // namespace screed
