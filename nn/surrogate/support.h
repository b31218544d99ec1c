// The ground under a robot, from heights alone: pitch and roll as in thesis 6.1, with the four
// points under the ends of the tracks in place of one ahead, one behind and one at each side.
#pragma once

#include <cmath>

#include "host_sim/core/elementary.h"

namespace screed::nn {

/// Where the tracks stand, from the robot's origin; the Rover 5's.
struct SupportGeometry {
  double half_length_m = 0.05;   ///< to the support points, ahead and behind
  double half_tread_m = 0.0635;  ///< to the middle of a track
  double wheel_radius_m = 0.03;
};

struct Support {
  double height_m;  ///< mean of the points
  double pitch;     ///< rad, nose up positive
  double roll;      ///< rad, left side up positive
};

/// height(x, y) is the ground's in m.
template <class Height>
Support support_on(const Height& height, const SupportGeometry& geometry, double x_m, double y_m,
                   double cos_heading, double sin_heading) {
  const double ahead_x = geometry.half_length_m * cos_heading;
  const double ahead_y = geometry.half_length_m * sin_heading;
  const double left_x = -geometry.half_tread_m * sin_heading;
  const double left_y = geometry.half_tread_m * cos_heading;
  const double front_left = height(x_m + ahead_x + left_x, y_m + ahead_y + left_y);
  const double front_right = height(x_m + ahead_x - left_x, y_m + ahead_y - left_y);
  const double rear_left = height(x_m - ahead_x + left_x, y_m - ahead_y + left_y);
  const double rear_right = height(x_m - ahead_x - left_x, y_m - ahead_y - left_y);
  const double along = (front_left + front_right) - (rear_left + rear_right);
  const double across = (front_left + rear_left) - (front_right + rear_right);
  return {0.25 * ((front_left + rear_left) + (front_right + rear_right)),
          portable::atan(along / (4.0 * geometry.half_length_m)),
          portable::atan(across / (4.0 * geometry.half_tread_m))};
}

}  // namespace screed::nn
