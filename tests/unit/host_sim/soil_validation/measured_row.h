// A row of measurements for tests.
#pragma once

#include "host_sim/soil_validation/soil_measurements.h"

namespace screed {

/// Nothing has been measured in it yet.
inline MeasuredWheel measured_row(double slip, double slip_angle_rad) {
  MeasuredWheel row;
  row.wheel.slip = slip;
  row.wheel.slip_angle_rad = slip_angle_rad;
  return row;
}

}  // namespace screed
