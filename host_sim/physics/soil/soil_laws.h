// Closed laws of the soil: Bekker's power as a table, passive pressure, the stress below a wheel.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/physics/kernels/kernels.h"
#include "host_sim/physics/soil/soil_parameters.h"

namespace screed {

// Bekker's pressure-sinkage law, p = (k_c / b + k_phi) z^n (M. G. Bekker, Introduction to
// Terrain-Vehicle Systems, 1969).

/// k_c / b + k_phi, Pa/m^n. `breadth_m`: b, the shorter side of what presses, or a disc's radius.
inline double bekker_modulus(const SoilParameters& soil, double breadth_m) {
  return soil.k_c / breadth_m + soil.k_phi;
}
/// At a depth z >= 0, Pa.
double bekker_pressure_pa(const SoilParameters& soil, double breadth_m, double depth_m);
/// The depth that bears this pressure, Pa >= 0.
double bekker_depth_m(const SoilParameters& soil, double breadth_m, double pressure_pa);

// Its z^n as a table: the power is asked for a thousand times a step.

/// z^n for z >= 0 by linear interpolation between points whose distance grows with z: 32 in each
/// octave from 2^-24 m (60 nm) to 1 m. Relative error below 5e-4 for n <= 2.5 (3e-5 for 0.5 and
/// 1.1). Below 60 nm a straight line to 0, above 1 m the last one goes on.
class PowerTable {
 public:
  explicit PowerTable(double exponent);

  double exponent() const { return exponent_; }
  /// For kernels: the same lines; as long as the table lives.
  PowerLines lines() const {
    return {&lines_.front().offset, static_cast<double>(kFirst), static_cast<double>(kLines - 1),
            kDropped};
  }
  double power(double z) const {
    // A double's leading bits are its octave and place in it.
    int64_t i = (std::bit_cast<int64_t>(z) >> kDropped) - kFirst + 1;
    i = i < 0 ? 0 : i;
    i = i < kLines ? i : kLines - 1;
    const Line& line = lines_[static_cast<size_t>(i)];
    return line.offset + z * line.slope;
  }

 private:
  struct Line {
    double offset;
    double slope;
  };
  static constexpr int kDropped = 52 - 5;  // keeps 5 of 52 mantissa bits: 32 points an octave
  static constexpr int64_t kFirst = std::bit_cast<int64_t>(0x1p-24) >> kDropped;
  static constexpr int64_t kLines = (std::bit_cast<int64_t>(1.0) >> kDropped) - kFirst + 1;

  double exponent_;
  std::vector<Line> lines_;
};

// Resistance of soil that a body pushes ahead of it or aside: the passive earth pressure on a
// vertical face (M. G. Bekker, Introduction to Terrain-Vehicle Systems, 1969; I. Hegedus, A
// simplified method for the determination of bulldozing resistance, Land Locomotion Laboratory
// report 61, 1960; for wheels G. Ishigami et al., Journal of Field Robotics 24(3), 2007).
//
//   X    = 45 degrees - phi / 2                            inclination of the sliding plane
//   D1   = cot X + tan(X + phi)
//   D2   = cot X + cot^2 X tan phi
//   R(z) = D1 (c z + 1/2 gamma z^2 D2)                     N per metre of width, of a face z deep

class PassivePressure {
 public:
  /// None where the soil's density is 0: not known.
  explicit PassivePressure(const SoilParameters& soil) {
    if (soil.density_kg_per_m3 <= 0.0) return;
    const double friction = soil.friction_deg * std::numbers::pi / 180.0;
    const double plane = 0.25 * std::numbers::pi - 0.5 * friction;
    const double cot = 1.0 / portable::tan(plane);
    const double d1 = cot + portable::tan(plane + friction);
    const double d2 = cot + cot * cot * portable::tan(friction);
    at_surface_ = d1 * soil.cohesion_pa;
    per_depth_ = d1 * d2 * soil.density_kg_per_m3 * kGravity_m_per_s2;
  }
  /// On the face, at a depth, Pa.
  double pressure(double depth_m) const { return at_surface_ + per_depth_ * depth_m; }
  /// On all of a face as deep as this, N/m.
  double resistance(double depth_m) const {
    return depth_m * (at_surface_ + 0.5 * per_depth_ * depth_m);
  }
  /// pressure() at the surface, Pa, and its growth with depth, Pa/m.
  double at_surface_pa() const { return at_surface_; }
  double per_depth_pa_per_m() const { return per_depth_; }
  bool none() const { return per_depth_ == 0.0; }

 private:
  double at_surface_ = 0.0;
  double per_depth_ = 0.0;
};

// What slip takes from the bearing of soil. Below a surface that only goes into the soil, or out of
// it, the soil bears as without slip; below one that only slides over it, by slip_bearing of that.
// Between them the share grows with the ratio of the speeds at which the surface moves along its
// normal and the soil flows along with it:
//   share = min(1, slip_bearing + (1 - slip_bearing) |v_normal| / flow)
//   flow  = 1.45 m^2 (v_sliding - 0.1 mm/s)
// m: the mobilised share of the shear strength (shear_field.h). The form is that of footings under
// an inclined load, whose capacity falls as they move along more than down (R. Nova, L. Montrasio,
// Geotechnique 41(2), 1991; G. Gottardi, G. T. Houlsby, R. Butterfield, Geotechnique 49(4), 1999).
// Its numbers are fitted to wheels: docs/studies/soil.md.

inline constexpr double kSlipFlow = 1.45;

/// Sliding by less does not count: a robot that stands on very soft soil, beside slopes that slide,
/// would else tremble for ever.
inline constexpr double kSlipStill_m_per_s = 1e-4;

inline double slip_flow(double mobilised_squared, double sliding_m_per_s) {
  return kSlipFlow * mobilised_squared * std::max(0.0, sliding_m_per_s - kSlipStill_m_per_s);
}

inline double bearing_under_slip(double slip_bearing, double normal, double flow) {
  if (!(std::abs(normal) < flow)) return 1.0;
  return slip_bearing + (1.0 - slip_bearing) * std::abs(normal) / flow;
}

// Where below a rolling wheel the soil's stress is greatest, and where contact ends (J. Y. Wong,
// A. R. Reece, Prediction of rigid wheel performance based on the analysis of soil-wheel stresses,
// Journal of Terramechanics 4(1 and 2), 1967).
//
// With angles from the lowest point of the wheel on its path, positive ahead, theta_1 where it
// enters the soil:
//   theta_m = c1 theta_1, s >= 0;   (c1 + c2_braked |s|) theta_1, s < 0
//   theta_2 = -c3 theta_1
// Ahead of theta_m a point bears as deep as it is. Behind, it bears as the point theta_e ahead
// does:
//   theta_e = theta_1 - (theta - theta_2) (theta_1 - theta_m) / (theta_m - theta_2)
// that is, as if it were higher by lift = r (cos max(theta, 0) - cos theta_e); what the lowest
// point has passed is as deep there as that point was. The ground comes up again by c3^2 of what
// the wheel pressed it down, nearly r (1 - cos theta_2).

class WheelStress {
 public:
  /// Greatest stress right below the axle and no contact behind it.
  WheelStress() = default;
  /// `slip` -1..1, positive driven. `rolled`, 0..1: how far the wheel has rolled since contact
  /// began, over the length of the contact: one that is set down bears evenly round its lowest
  /// point.
  WheelStress(const SoilParameters& soil, double radius_m, double entry_rad, double slip,
              double rolled) {
    const double share = soil.front_angle + soil.front_angle_braked * std::max(0.0, -slip);
    const double middle = std::clamp(share, 0.0, kMaxAhead) * entry_rad;
    known_ = true;
    shape_.entry = entry_rad;
    shape_.exit = -soil.exit_angle * entry_rad;
    shape_.shaped = rolled > 0.0 && middle - shape_.exit > kMinSpread_rad;
    if (!shape_.shaped) return;
    shape_.middle = middle;
    shape_.slope = (entry_rad - middle) / (middle - shape_.exit);
    shape_.scale = rolled * radius_m;
  }

  bool shaped() const { return shape_.shaped; }
  /// Whether the entry angle is known.
  bool known() const { return known_; }
  double entry_rad() const { return shape_.entry; }
  double exit_rad() const { return shape_.exit; }
  /// For kernels.
  const StressShape& shape() const { return shape_; }

  /// By how much a point at this sine of theta bears as if it were higher, m.
  double lift(double sine) const { return best_kernels().stress_lift(shape_, sine); }

 private:
  static constexpr double kMaxAhead = 0.95;
  static constexpr double kMinSpread_rad = 1e-4;

  bool known_ = false;
  StressShape shape_;
};

}  // namespace screed
