// Calibration of an IMU by hand: collecting the motions, and fitting the errors.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/protocol/slcan.h"

namespace screed {

// What an IMU's raw measurements say about its errors: gyro bias at rest, accelerometer offset and
// scale from six positions, magnetometer ellipsoid. Pure least squares; knows no robot and no link.
//
// Every fit refuses data that cannot tell what it is asked for, with one line for the person who
// holds the robot.

/// Corrected = matrix * (raw - offset).
struct VectorCorrection {
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();

  Eigen::Vector3d apply(const Eigen::Vector3d& raw) const { return matrix * (raw - offset); }
};

struct VectorFit {
  VectorCorrection correction;
  double radius = 0.0;  ///< length that corrected vectors have
  /// Relative RMS deviation of the lengths from their mean: of the raw vectors, of those with the
  /// offset alone taken away, and of the corrected ones.
  double residual_before = 0.0;
  double residual_offset = 0.0;
  double residual_after = 0.0;
};

struct GyroFit {
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();       ///< unit of the samples
  Eigen::Vector3d deviation = Eigen::Vector3d::Zero();  ///< of a single sample
};

/// Mean at rest. `max_deviation`: of an axis, above which the robot was moved, in the unit of the
/// samples. Throws RunError: fewer than 20 samples, or moved.
GyroFit fit_gyro(std::span<const Eigen::Vector3d> samples, double max_deviation);

/// The six positions: which way is up in the robot's frame.
enum class Position { kLevel, kUpsideDown, kNoseUp, kNoseDown, kLeftUp, kRightUp };
constexpr size_t kPositions = 6;
const char* position_name(Position position);

/// The position that a specific force shows; nothing when it is more than 30 degrees from each.
std::optional<Position> position_of(const Eigen::Vector3d& force);

/// Offset and scale of each axis from the mean force in each position, by the rule that every
/// corrected one has the length `gravity` (Gauss-Newton; positions need not be exact). Throws
/// RunError when the lengths differ so much that the sensor, or the person, is at fault.
VectorFit fit_accelerometer(const std::array<Eigen::Vector3d, kPositions>& forces, double gravity);

/// The ellipsoid through the samples: its centre is the hard iron, the symmetric matrix that makes
/// a sphere of it the soft iron. Keeps the mean radius. Least squares of the algebraic distance in
/// centred and scaled coordinates. Throws RunError when there are fewer than 20 samples, when they
/// do not reach round (all in a plane, a patch of the sphere), or when they lie on no ellipsoid.
VectorFit fit_ellipsoid(std::span<const Eigen::Vector3d> samples);

/// Share of the directions round `centre` in which there is a sample: 0..1, by 26 even patches.
double coverage(std::span<const Eigen::Vector3d> samples, const Eigen::Vector3d& centre);

// Collects the motions of a hand-held robot into the data that the fits of imu_calibration.h
// need: samples at rest, the mean force in each of six positions, magnetometer samples all round.
//
// Takes the raw frames in the order they come; positions may be held in any order, and again.

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
