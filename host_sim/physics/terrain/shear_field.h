// Mobilised shear along a footprint's running surface: a chain of places that moves with its
// material (belt, rim), two lanes side by side. Soil gives back to each place what that place has
// slid over it since it came into contact, as Wong counts shear displacement: along the rim or
// belt, not over the ground. In steady driving this is his formula, j = s x from the front of a
// belt; in turns, reversals and at rest it stays right.
// What has been sheared lies on the ground: a surface that loses contact for a moment finds it
// again, but where it has left that ground meanwhile.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/physics/kernels/kernels.h"

namespace screed {

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
