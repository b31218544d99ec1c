// Where below a rolling wheel the soil's stress is greatest, and where contact ends (J. Y. Wong,
// A. R. Reece, Prediction of rigid wheel performance based on the analysis of soil-wheel stresses,
// Journal of Terramechanics 4(1 and 2), 1967).
//
// With angles from the lowest point of the wheel on its path, positive ahead, theta_1 where it
// enters the soil:
//   theta_m = (c1 + c2 s) theta_1, s >= 0;   (c1 + c2_braked |s|) theta_1, s < 0
//   theta_2 = -c3 theta_1
// Ahead of theta_m a point bears as deep as it is. Behind, it bears as the point theta_e ahead
// does:
//   theta_e = theta_1 - (theta - theta_2) (theta_1 - theta_m) / (theta_m - theta_2)
// that is, as if it were higher by lift = r (cos max(theta, 0) - cos theta_e); what the lowest
// point has passed is as deep there as that point was. The ground comes up again by c3^2 of what
// the wheel pressed it down, nearly r (1 - cos theta_2).
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/double2.h"

namespace screed {

class WheelStress {
 public:
  /// Greatest stress right below the axle and no contact behind it.
  WheelStress() = default;
  /// `slip` -1..1, positive driven. `rolled`, 0..1: how far the wheel has rolled since contact
  /// began, over the length of the contact: one that is set down bears evenly round its lowest
  /// point.
  WheelStress(const SoilParameters& soil, double radius_m, double entry_rad, double slip,
              double rolled)
      : radius_(radius_m), entry_(entry_rad), rolled_(rolled) {
    const double share = slip >= 0.0 ? soil.front_angle + soil.front_angle_driven * slip
                                     : soil.front_angle - soil.front_angle_braked * slip;
    const double middle = std::clamp(share, 0.0, kMaxAhead) * entry_;
    exit_ = -soil.exit_angle * entry_;
    known_ = true;
    shaped_ = rolled > 0.0 && middle - exit_ > kMinSpread_rad;
    if (!shaped_) return;
    middle_ = middle;
    slope_ = (entry_ - middle) / (middle - exit_);
  }

  bool shaped() const { return shaped_; }
  /// Whether the entry angle is known.
  bool known() const { return known_; }
  double entry_rad() const { return entry_; }
  double exit_rad() const { return exit_; }

  /// By how much the points at these sines of theta bear as if they were higher, m.
  Double2 lift(Double2 sine) const {
    const Double2 one = broadcast(1.0);
    const Double2 cosine = square_root(maximum(one - sine * sine, broadcast(0.0)));
    // Twice the arc tangent of the half angle's tangent.
    const Double2 theta = broadcast(2.0) * arc_tangent(sine / (one + cosine));
    const Double2 mapped =
        minimum(broadcast(entry_) - (theta - broadcast(exit_)) * broadcast(slope_),
                broadcast(std::numbers::pi));
    const Double2 behind = theta < broadcast(middle_) ? one : broadcast(0.0);
    const Double2 level = theta > broadcast(0.0) ? cosine : one;
    return behind * broadcast(rolled_ * radius_) * (level - cosine_of(mapped));
  }

 private:
  static constexpr double kMaxAhead = 0.95;
  static constexpr double kMinSpread_rad = 1e-4;

  /// |t| <= 1, within 1e-5 (form of Abramowitz and Stegun, 4.4.49).
  static Double2 arc_tangent(Double2 t) {
    const Double2 q = t * t;
    Double2 sum = broadcast(-0.0117212);
    for (const double a : {0.05265332, -0.11643287, 0.19354346, -0.33262347, 0.99997726})
      sum = sum * q + broadcast(a);
    return sum * t;
  }
  /// 0 <= x <= pi, Taylor's series about pi/2 of -sin(x - pi/2); within 4e-6.
  static Double2 cosine_of(Double2 x) {
    const Double2 y = x - broadcast(0.5 * std::numbers::pi);
    const Double2 q = y * y;
    Double2 sum = broadcast(1.0 / 362880.0);
    for (const double a : {-1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0, 1.0})
      sum = sum * q + broadcast(a);
    return -(sum * y);
  }

  bool known_ = false;
  bool shaped_ = false;
  double radius_ = 0.0;
  double entry_ = 0.0;
  double middle_ = 0.0;
  double exit_ = 0.0;
  double slope_ = 0.0;
  double rolled_ = 0.0;
};

}  // namespace screed
