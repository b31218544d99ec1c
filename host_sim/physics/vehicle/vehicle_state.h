// What can be read off a robot in its world, whatever moves it there: rigid bodies (vehicle.h) or
// a network that stands in for them.
#pragma once

#include <Eigen/Geometry>

namespace screed {

enum Side : int { kLeft = 0, kRight = 1 };

/// Pose and motion of the frame of the chassis (x forward, y left, z up).
struct ChassisState {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();  ///< chassis to world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< of the frame's origin, world frame, m/s
  Eigen::Vector3d omega_body = Eigen::Vector3d::Zero();  ///< rad/s, chassis frame
};

/// Roll (left side up), pitch (nose up), heading (counter-clockwise from east), rad.
struct Attitude {
  double roll;
  double pitch;
  double heading;
};
Attitude attitude_of(const Eigen::Matrix3d& body_to_world);
/// The inverse: heading first, then pitch, then roll.
Eigen::Matrix3d rotation_from(const Attitude& attitude);

class VehicleState {
 public:
  virtual ~VehicleState() = default;

  virtual ChassisState chassis() const = 0;
  /// Of the side's driven unit: surface speed over the wheels, angle of the encoder's shaft, motor
  /// current (all motors of the side).
  virtual double track_speed_m_per_s(Side side) const = 0;
  virtual double shaft_angle_rad(Side side) const = 0;
  virtual double current_a(Side side) const = 0;
  virtual double wheel_radius_m(Side side) const = 0;
  /// What the side's running gear carries, vertically, and how deep it sinks in (its deepest unit).
  virtual double load_n(Side side) const = 0;
  virtual double sinkage_m(Side side) const = 0;
  /// Speed over the ground at the middle of the side's running gear, along its x, m/s.
  virtual double ground_speed_m_per_s(Side side) const = 0;

 protected:
  VehicleState() = default;
  VehicleState(const VehicleState&) = default;
  VehicleState& operator=(const VehicleState&) = default;
};

}  // namespace screed
