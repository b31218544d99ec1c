// One robot of the stand-in's world: motors and battery as they are, belts that move it, a body
// that lies on the ground as its belts do.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/core/rotation.h"
#include "host_sim/physics/vehicle/drive_shaft.h"
#include "host_sim/physics/vehicle/vehicle_state.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/plant_options.h"
#include "host_sim/standin/belt_ground.h"
#include "host_sim/standin/belt_motion.h"
#include "host_sim/standin/driving_state.h"

namespace screed {

/// What robots of one kind have in common.
struct StandInKind {
  TrackGeometry tracks;
  GearMotor motor;
  Battery battery;
  Eigen::AlignedBox2d outline;                    ///< round the robot from above, in its axes
  Eigen::Vector3d imu = Eigen::Vector3d::Zero();  ///< in its axes
};

class StandInRobot final : public RobotView, public VehicleState {
 public:
  /// `world`, which outlives it, has the clock; `ground` what robot `number` stands on.
  StandInRobot(const Environment& world, BeltGround& ground, std::size_t number,
               const StandInKind& kind, const SoilParameters& soil, const BeltFit& fit,
               const StartPose& start);

  /// Standing there, it goes on from there.
  void set_state(const DrivingState& state);
  /// Of its origin, as travelled.
  const PlanarPose& pose() const { return pose_; }
  /// Its belts run at these speeds, m/s, left and right, whatever the motors do.
  void run_belts(const std::array<double, 2>& belts_m_per_s);

  /// A part of a frame: motors and battery.
  void step_motors(const DutyRatio& duty, double dt);
  /// The frame's end: the belts move it.
  void move();
  /// The same where something else moves it, to this pose.
  void follow(const PlanarPose& pose, const FrameMotion& motion);
  /// A stride's end: it presses the ground.
  void press();
  /// The frame's end, after move() and press(): the body follows.
  void end_frame();

  /// A force, N, at a place in the next frame, both in the world's axes.
  void push(const Eigen::Vector2d& at, const Eigen::Vector2d& force);
  Eigen::Vector2d middle() const { return {pose_.x_m, pose_.y_m}; }
  /// To the world's axes.
  Eigen::Matrix2d heading() const { return rotation_by(pose_.heading_rad); }
  const Eigen::AlignedBox2d& outline() const { return kind_.outline; }
  std::array<Eigen::Vector2d, 4> corners() const;
  /// Of the body there, m/s.
  Eigen::Vector2d velocity_at(const Eigen::Vector2d& place) const;

  // RobotView
  ImuTruth motion() const override;
  void lay_on_side() override;
  int steps_per_tick() const override { return world_.steps_per_tick(); }
  uint64_t steps() const override { return world_.steps(); }
  double time_s() const override { return world_.time_s(); }
  const HeightField& terrain() const override { return ground_.surface(); }
  bool is_deformable() const override { return true; }
  VolumeBalance volume_balance() const override { return ground_.balance(); }
  const VehicleState& vehicle() const override { return *this; }
  const std::array<int64_t, 2>& wrap_counts() const override { return wrap_counts_; }
  Eigen::Vector3d unwrapped_position() const override { return now_.place; }
  const Battery& battery() const override { return battery_; }

  // VehicleState
  ChassisState chassis() const override;
  double track_speed_m_per_s(Side side) const override;
  double shaft_angle_rad(Side side) const override;
  double current_a(Side side) const override;
  double wheel_radius_m(Side /*side*/) const override { return kind_.tracks.radius_m; }
  double load_n(Side side) const override;
  double sinkage_m(Side side) const override;
  double ground_speed_m_per_s(Side side) const override;

 private:
  struct BodyPose {
    Attitude attitude{};
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of the origin, as travelled
    /// Of the attitude, worked out once: much asks for it in every frame.
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  };
  BodyPose body_pose() const;
  void set_at_rest();
  void count_wraps();

  const Environment& world_;
  BeltGround& ground_;
  std::size_t number_;
  StandInKind kind_;
  std::array<DriveShaft, 2> shafts_;
  std::array<double, 2> angle_offset_rad_{};
  Battery battery_;
  BeltMotion belts_;
  PlanarPose pose_;
  FrameMotion motion_;
  BeltStrideRecorder stride_;
  Eigen::Vector3d push_ = Eigen::Vector3d::Zero();  ///< forward, to the left, torque
  TrackPlane plane_;                                ///< that the body follows
  BodyPose now_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();      ///< of the origin
  Eigen::Vector3d imu_velocity_ = Eigen::Vector3d::Zero();  ///< over the last frame
  Eigen::Vector3d imu_velocity_before_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_body_ = Eigen::Vector3d::Zero();
  std::array<int64_t, 2> wrap_counts_ = {0, 0};
  bool on_side_ = false;
};

}  // namespace screed
