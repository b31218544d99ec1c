// How a wheel in the testbed moves over time.
#pragma once

#include <string>
#include <vector>

namespace screed {

/// Speeds over the ground, in the wheel's own axes, and of its rim, m/s.
struct WheelMotion {
  double ahead = 0.0;
  double left = 0.0;
  double rim = 0.0;
};

/// A moment of a wheel whose motion changes.
struct WheelSample {
  double time_s = 0.0;
  double travel_m = 0.0;     ///< ahead
  double slip_path_m = 0.0;  ///< of the rim, less the travel ahead
  double side_path_m = 0.0;  ///< to the left
  double sinkage_m = 0.0;
  double drawbar_pull_n = 0.0;
  double side_force_n = 0.0;
};

class WheelSchedule {
 public:
  struct Moment {
    double time_s;
    WheelMotion motion;
  };

  /// What is between two moments is linear; behind the last one it is as there. Throws InputError
  /// without a moment, unless times rise from 0, and for speeds beyond 10 m/s.
  explicit WheelSchedule(std::vector<Moment> moments);

  WheelMotion at(double time_s) const;
  double duration_s() const { return moments_.back().time_s; }
  const std::vector<Moment>& moments() const { return moments_; }

 private:
  std::vector<Moment> moments_;
};

/// From a CSV file with a head line: time_s, rim_m_s, travel_m_s, and slip_angle_deg, of travel to
/// the left of the wheel's plane (0 without this column). Throws InputError with file and line.
WheelSchedule read_wheel_schedule(const std::string& file);

/// A wheel that rolls without slip, whose rim then goes over to `rim` with this time constant.
/// `travel`: over the ground, at this angle to the left of the wheel's plane.
WheelSchedule step_of_slip(double travel_m_per_s, double slip_angle_rad, double rim_m_per_s,
                           double time_constant_s, double duration_s);

}  // namespace screed
