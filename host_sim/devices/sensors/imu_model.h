// The AltIMU-10 v4 as its data sheets describe it: true motion in, raw counts out.
//
// Noise, bias, scale error, full scale and quantisation are those of LSM303D (accelerometer,
// magnetometer), L3GD20H (gyro) and LPS25H (pressure) at the ranges the firmware configures: +-8
// g, +-4 G, +-2000 degrees/s, and so are the rates. Biases and scale errors are drawn once per
// world; what a calibration leaves behind, not what the chip leaves the factory with, where the
// firmware relies on one.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "hal/sample.h"
#include "host_sim/core/random.h"
#include "host_sim/physics/world/environment.h"

namespace screed {

/// Typical figures of the data sheets; all 1 sigma.
struct ImuErrors {
  // L3GD20H: noise density 0.011 degree/s/sqrt(Hz); over the 50 Hz band of 100 Hz output 0.078
  // degree/s.
  double gyro_noise_dps = 0.078;
  // left after the zero-rate level (+-25 degrees/s) was stored by a calibration at power-up
  double gyro_bias_dps = 0.5;
  double gyro_scale = 0.01;
  // LSM303D: acceleration noise density 150 ug/sqrt(Hz), 50 Hz band: 1.1 mg.
  double accel_noise_mg = 1.1;
  double accel_bias_mg = 8.0;  // +-60 mg typical before the six-position calibration
  double accel_scale = 0.005;
  // LSM303D: 5 mG RMS.
  double mag_noise_mgauss = 5.0;
  double mag_bias_mgauss = 10.0;  // hard iron left after calibration
  double mag_soft_iron = 0.0;     // of each element of the matrix that the field goes through
  // LPS25H: 0.01 hPa RMS with its internal average.
  double pressure_noise_hpa = 0.01;
  double pressure_bias_hpa = 0.2;

  /// No noise, bias or scale error: only quantisation and full scale remain.
  static ImuErrors none() { return {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}; }
  /// As the chips come: typical offsets of the data sheets, and the hard and soft iron of a robot's
  /// own steel round the magnetometer.
  static ImuErrors uncalibrated() {
    ImuErrors errors;
    errors.gyro_bias_dps = 8.0;
    errors.accel_bias_mg = 40.0;
    errors.accel_scale = 0.01;
    errors.mag_bias_mgauss = 120.0;
    errors.mag_soft_iron = 0.03;
    return errors;
  }
  /// As none(), but the gyro's last digit flickers: one that repeats itself to the bit is dead, and
  /// the firmware does not arm with it.
  static ImuErrors quiet() {
    ImuErrors errors = none();
    errors.gyro_noise_dps = 0.035;
    return errors;
  }
};

class ImuModel {
 public:
  ImuModel(uint64_t seed, const ImuErrors& errors);

  /// Counts of gyro, accelerometer, magnetometer (every tick) and pressure (25 Hz), with the
  /// FreshBits that go with them.
  void measure(const ImuTruth& truth, SensorSample& sample);

  // What each sensor feels, in the robot frame, before its chip makes counts of it; a call is a
  // measurement with its own noise.
  Eigen::Vector3d gyro_dps(const ImuTruth& truth);
  Eigen::Vector3d accel_mg(const ImuTruth& truth);
  Eigen::Vector3d mag_mgauss(const ImuTruth& truth);
  double pressure_hpa(const ImuTruth& truth);
  static constexpr double kTemperature_degc = 20.0;

  /// The nearest count of a 16-bit sensor; saturates.
  static int16_t quantise(double value, double lsb);

  /// The earth's field in world axes (east, north, up), gauss: declination 0, inclination 68
  /// degrees, as in Newfoundland.
  static Eigen::Vector3d earth_field_gauss();

 private:
  ImuErrors errors_;
  WorldRandom gyro_random_;
  WorldRandom accel_random_;
  WorldRandom mag_random_;
  WorldRandom baro_random_;
  Eigen::Vector3d gyro_bias_dps_;
  Eigen::Vector3d gyro_scale_;
  Eigen::Vector3d accel_bias_mg_;
  Eigen::Vector3d accel_scale_;
  Eigen::Vector3d mag_bias_mgauss_;
  Eigen::Matrix3d mag_soft_iron_;
  double pressure_bias_hpa_;
  uint32_t ticks_ = 0;
};

// A person who takes the robot into the hands and turns it over, as `screed calibrate` asks: what
// its IMU feels. A script over time, again and again; knows no physics and no robot.

/// True motion over the tick that ends at time_s: level, six positions held still, then turned
/// slowly through all directions, and level again. The whole takes kCalibrationMotionPeriod_s.
constexpr double kCalibrationMotionPeriod_s = 126.0;
ImuTruth calibration_motion(double time_s);

}  // namespace screed
