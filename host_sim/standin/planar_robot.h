// A robot without dynamics: shafts, battery and a body that is moved from frame to frame, whoever
// works out where to, and what its sensors feel of that. The stand-in's robots and the networks'
// are of this kind; a frame is a control tick.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/drive_train.h"
#include "host_sim/physics/vehicle/vehicle_state.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/standin/planar_pose.h"

namespace screed {

class PlanarRobot : public RobotView, public VehicleState {
 public:
  struct Kind {
    GearMotor motor;
    Battery battery;
    double wheel_radius_m = 0.0;  ///< track included
    double half_tread_m = 0.0;
    Eigen::Vector3d imu = Eigen::Vector3d::Zero();  ///< in the robot's axes
  };

  // RobotView
  ImuTruth motion() const override;
  void lay_on_side() override;
  const VehicleState& vehicle() const override { return *this; }
  const std::array<int64_t, 2>& wrap_counts() const override { return wrap_counts_; }
  Eigen::Vector3d unwrapped_position() const override { return now_.place; }
  const Battery& battery() const override { return battery_; }

  // VehicleState
  ChassisState chassis() const override;
  double track_speed_m_per_s(Side side) const override;
  double shaft_angle_rad(Side side) const override;
  double current_a(Side side) const override;
  double wheel_radius_m(Side /*side*/) const override { return kind_.wheel_radius_m; }
  double ground_speed_m_per_s(Side side) const override;

 protected:
  struct BodyPose {
    Attitude attitude{};
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of the origin, as travelled
    /// Of the attitude, worked out once: much asks for it in every frame.
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  };

  /// `ground`, which outlives it, says whether the bed wraps around.
  PlanarRobot(const HeightField& ground, const Kind& kind);

  /// Tracks run at these speeds, m/s, left and right, whatever the motors do.
  void spin_tracks(const std::array<double, 2>& m_per_s);
  /// A part of a frame: motors against these torques on their shafts, N m, and the battery.
  void step_shafts(const DutyRatio& duty, const std::array<double, 2>& torque_nm, double dt);
  /// Goes on from there, with the body at `body`.
  void begin_at(const DrivingState& state, const BodyPose& body);
  /// The frame's end: the body has come to `body`. Throws RunError where it cannot be.
  void move_body(const BodyPose& body);
  void stand_still();

  double wheel_rate_rad_per_s(Side side) const {
    return shafts_[static_cast<std::size_t>(side)].omega_rad_per_s();
  }
  const BodyPose& body() const { return now_; }
  const Eigen::Vector3d& velocity() const { return velocity_; }  ///< of the origin
  bool on_side() const { return on_side_; }

 private:
  void check(const BodyPose& body) const;
  void count_wraps();

  const HeightField& ground_;
  Kind kind_;
  std::array<DriveShaft, 2> shafts_;
  std::array<double, 2> angle_offset_rad_{};
  Battery battery_;
  BodyPose now_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d imu_velocity_ = Eigen::Vector3d::Zero();  ///< over the last frame
  Eigen::Vector3d imu_velocity_before_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_body_ = Eigen::Vector3d::Zero();
  std::array<int64_t, 2> wrap_counts_ = {0, 0};
  bool on_side_ = false;
};

}  // namespace screed
