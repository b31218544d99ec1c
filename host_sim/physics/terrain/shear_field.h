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

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/kernels/kernels.h"

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

// Mobilised shear along a footprint's running surface: a chain of places that moves with its
// material (belt, rim), two lanes side by side. Soil gives back to each place what that place has
// slid over it since it came into contact, as Wong counts shear displacement: along the rim or
// belt, not over the ground. In steady driving this is his formula, j = s x from the front of a
// belt; in turns, reversals and at rest it stays right.
// What has been sheared lies on the ground: a surface that loses contact for a moment finds it
// again, but where it has left that ground meanwhile.

/// The lower run of a footprint: a straight part with an arc at either end (radius 0: none).
/// `along` is the distance along it from its middle, m, positive ahead.
struct RunContour {
  double half_m = 0.0;    ///< half of the straight part
  double radius_m = 0.0;  ///< of the arcs
  double below_m = 0.0;   ///< of the straight part below the body's centre
  double half_width_m = 0.0;

  double length_m() const;
  /// Of a point `ahead` of the middle in the body's axes, m.
  double along(double ahead_m) const;
};

/// How a body moves, in the axes of its contour: ahead, left, up.
struct RunMotion {
  Eigen::Vector3d velocity;    ///< of its centre, m/s
  Eigen::Vector3d omega;       ///< rad/s
  double surface_speed = 0.0;  ///< of the material over the body, backwards on the contour, m/s
  bool sideways_only = false;  ///< sliding along counts as none
  bool level = false;          ///< sliding counts in the plane of the run, not along the arcs
};

class ShearField {
 public:
  struct Value {
    double along = 0.0;    ///< mobilised share of the strength, positive: the surface slid ahead
    double across = 0.0;   ///< ... to the left
    double sliding = 0.0;  ///< speed of the surface over the soil, m/s
  };

  /// A step of `dt` seconds in which the contour touches between `rear` and `front` (along it, m).
  void advance(const RunContour& contour, const RunMotion& motion, double rear, double front,
               double shear_modulus_m, double damping_s, double dt,
               const Kernels& kernels = best_kernels());
  /// A step of `dt` seconds in the air: the ground that was sheared stays where it is.
  void hover(const RunContour& contour, const RunMotion& motion, double dt);
  /// At `along` the contour and `across`, m, of the last step.
  Value at(double along, double across) const;
  /// For kernels that look up many at once; until the next advance().
  ShearView view() const;
  template <typename Archive>
  void serialize(Archive& archive) {
    archive(arrays_, room_, base_, spacing_, travelled_, lane_offset_, touching_, from_front_,
            rear_, front_, first_, last_);
  }

 private:
  static constexpr int kLanes = 2;
  /// Properties of a place, an array each: its state, and what at() gives.
  enum Property : uint8_t {
    kAlong,
    kAcross,
    kYield,
    kAheadAlong,
    kAheadAcross,
    kValueAlong,
    kValueAcross,
    kSliding,
    kFlowing,  // what of the sliding is plastic, m/s
    kProperties
  };
  void lay_out(const RunContour& contour);
  bool leave_behind(const RunContour& contour, const RunMotion& motion, double dt);
  void make_room(int64_t first, int64_t last);
  double* array(int lane, Property property, int64_t index) const {
    return const_cast<double*>(arrays_.data()) +
           static_cast<size_t>(lane * kProperties + property) * room_ +
           static_cast<size_t>(index - base_);
  }
  ShearPlaces places_from(int64_t index) const;

  std::vector<double> arrays_;
  size_t room_ = 0;         // places in an array
  int64_t base_ = 0;        // the place that the arrays begin with
  double spacing_ = 0.0;    // of places, m
  double travelled_ = 0.0;  // of the material, backwards, m
  double lane_offset_ = 0.0;
  bool touching_ = false;   // or there is sheared ground below
  bool from_front_ = true;  // where material comes into contact
  double rear_ = 0.0;       // of the sheared ground below, along the contour
  double front_ = 0.0;
  int64_t first_ = 0;  // places over it
  int64_t last_ = -1;
};

}  // namespace screed
