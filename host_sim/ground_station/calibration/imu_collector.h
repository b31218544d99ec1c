// Collects the motions of a hand-held robot into the data that the fits of imu_fit.h
// need: samples at rest, the mean force in each of six positions, magnetometer samples all round.
//
// Takes the raw frames in the order they come; positions may be held in any order, and again.
#pragma once

#include <array>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "firmware/protocol/slcan.h"
#include "host_sim/ground_station/calibration/imu_fit.h"

namespace screed {

/// Everything in counts of the sensors, as the robot's parameters are.
struct ImuCalibration {
  GyroFit gyro;
  VectorFit accelerometer;
  VectorFit magnetometer;
};

/// One parameter of the robot that a calibration decides.
struct CalibrationParameter {
  std::string name;
  int16_t value;
};
std::vector<CalibrationParameter> calibration_parameters(const ImuCalibration& calibration);

class ImuCollector {
 public:
  /// Samples of a rest that count: 1.5 s at 10 Hz, behind the first ones after a movement.
  static constexpr size_t kRestSamples = 15;
  static constexpr double kEnoughCoverage = 0.8;
  static constexpr size_t kEnoughMagSamples = 60;

  /// Looks at ACCEL_RAW, GYRO_RAW and MAG_RAW; all frames are of one robot.
  void add_frame(const CanFrame& frame);

  /// The robot has not moved for a while.
  bool at_rest() const { return still_ >= kRestSamples; }
  /// The position it is held in now.
  std::optional<Position> position() const;
  bool position_done(Position position) const {
    return rests_.at(static_cast<size_t>(position)).count >= kRestSamples;
  }
  bool positions_done() const;
  const std::vector<Eigen::Vector3d>& mag_samples() const { return mag_; }
  /// Of the directions that the magnetometer has seen, 0..1. Never falls, although the middle from
  /// which directions are seen moves with the samples; reaches kEnoughCoverage when the samples are
  /// enough, and not before.
  double mag_coverage() const { return mag_coverage_; }
  bool complete() const;

  /// The fits. Throws RunError as they do, and when a position is missing.
  ImuCalibration fit() const;

  /// What to do next, for the person who holds the robot.
  std::string advice() const;

 private:
  void add_mag(const Eigen::Vector3d& sample);

  struct Rest {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    size_t count = 0;
  };

  std::deque<Eigen::Vector3d> recent_gyro_;
  std::deque<Eigen::Vector3d> recent_accel_;
  size_t still_ = 0;  ///< samples since the last movement
  std::vector<Eigen::Vector3d> rest_gyro_;
  std::array<Rest, kPositions> rests_;
  std::vector<Eigen::Vector3d> mag_;
  Eigen::Vector3d least_mag_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d most_mag_ = Eigen::Vector3d::Zero();
  double mag_coverage_ = 0.0;
};

}  // namespace screed
