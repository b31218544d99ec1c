// How much of its shear strength soil mobilises at one place of a surface that slides over it.
//
// Under steady sliding in one direction the curve of Janosi and Hanamoto (1961), whatever is below:
//   m = 1 - exp(-j / K),          m = tau / strength, j the displacement since contact began
// Around a state that has been reached soil is elastic, on a line of slope 1 / (kElastic K); only
// beyond the greatest share so far, the `yield`, does it shear on along the curve (isotropic
// hardening with a return to the yield surface; Simo and Hughes, Computational Inelasticity, 1998,
// ch. 1). So what stands on a slope stays, however it trembles, and gives back only the small
// elastic part. When shear turns round, and passes zero, the curve begins anew: soil that is
// unloaded and sheared again starts from zero displacement (Wong, Theory of Ground Vehicles, ch. 2,
// repeated shear).
#pragma once

#include <cmath>

#include "host_sim/core/elementary.h"

namespace screed {

/// 1 - exp(-x), x >= 0: x is mostly small, and there Pade's fraction of second order is within
/// 2e-8.
inline double fading(double x) {
  return x < 0.1 ? 12.0 * x / (12.0 + x * (6.0 + x)) : 1.0 - portable::exp(-x);
}

/// Of one place of the surface. Vectors point along the surface and across it, in the direction in
/// which it has slid.
struct ShearState {
  /// Displacement of the elastic part, over K.
  static constexpr double kElastic = 0.1;

  double along = 0.0;        ///< mobilised share of the shear strength
  double across = 0.0;       ///< their length is at most `yield`
  double yield = 0.0;        ///< greatest share since shear last passed zero, 0..1
  double ahead_along = 1.0;  ///< direction in which it last yielded, unit length
  double ahead_across = 0.0;

  /// The surface slides by a displacement over K.
  void slide(double along_per_k, double across_per_k) {
    along += along_per_k * (1.0 / kElastic);
    across += across_per_k * (1.0 / kElastic);
    if (along * ahead_along + across * ahead_across < 0.0) yield = 0.0;
    const double square = along * along + across * across;
    if (square <= yield * yield) return;
    const double length = std::sqrt(square);
    yield += (1.0 - yield) * fading((length - yield) * kElastic);
    ahead_along = along / length;
    ahead_across = across / length;
    along = ahead_along * yield;
    across = ahead_across * yield;
  }
};

}  // namespace screed
