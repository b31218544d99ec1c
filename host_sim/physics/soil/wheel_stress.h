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

#include "host_sim/physics/kernels/kernels.h"
#include "host_sim/physics/soil/soil_parameters.h"

namespace screed {

class WheelStress {
 public:
  /// Greatest stress right below the axle and no contact behind it.
  WheelStress() = default;
  /// `slip` -1..1, positive driven. `rolled`, 0..1: how far the wheel has rolled since contact
  /// began, over the length of the contact: one that is set down bears evenly round its lowest
  /// point.
  WheelStress(const SoilParameters& soil, double radius_m, double entry_rad, double slip,
              double rolled) {
    const double share = slip >= 0.0 ? soil.front_angle + soil.front_angle_driven * slip
                                     : soil.front_angle - soil.front_angle_braked * slip;
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
