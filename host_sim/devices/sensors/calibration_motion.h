// A person who takes the robot into the hands and turns it over, as `screed calibrate` asks: what
// its IMU feels. A script over time, again and again; knows no physics and no robot.
#pragma once

#include "host_sim/devices/sensors/imu_model.h"

namespace screed {

/// True motion over the tick that ends at time_s: level, six positions held still, then turned
/// slowly through all directions, and level again. The whole takes kCalibrationMotionPeriod_s.
constexpr double kCalibrationMotionPeriod_s = 126.0;
ImuTruth calibration_motion(double time_s);

}  // namespace screed
