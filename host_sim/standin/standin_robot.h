// One robot of the stand-in's world: motors and battery as they are, belts that move it, a body
// that lies on the ground as its belts do.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>

#include "host_sim/core/rotation.h"
#include "host_sim/physics/world/plant_options.h"
#include "host_sim/standin/belt_ground.h"
#include "host_sim/standin/belt_motion.h"
#include "host_sim/standin/driving_state.h"
#include "host_sim/standin/planar_robot.h"

namespace screed {

/// What robots of one kind have in common.
struct StandInKind {
  PlanarRobot::Kind planar;
  TrackGeometry tracks;
  Eigen::AlignedBox2d outline;  ///< round the robot from above, in its axes
};

class StandInRobot final : public PlanarRobot {
 public:
  /// `ground`, which outlives it, is what robot `number` stands on.
  StandInRobot(BeltGround& ground, std::size_t number, const StandInKind& kind,
               const SoilParameters& soil, const BeltFit& fit, const StartPose& start);

  /// Standing there, it goes on from there.
  void set_state(const DrivingState& state);
  /// Of its origin, as travelled.
  const PlanarPose& pose() const { return pose_; }
  /// Its belts run at these speeds, m/s, left and right, whatever the motors do.
  void run_belts(const std::array<double, 2>& belts_m_per_s) { spin_tracks(belts_m_per_s); }

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

  // VehicleState
  double load_n(Side side) const override;
  double sinkage_m(Side side) const override;

 private:
  BodyPose body_pose() const;

  BeltGround& ground_;
  std::size_t number_;
  StandInKind kind_;
  BeltMotion belts_;
  PlanarPose pose_;
  FrameMotion motion_;
  BeltStrideRecorder stride_;
  Eigen::Vector3d push_ = Eigen::Vector3d::Zero();  ///< forward, to the left, torque
  TrackPlane plane_;                                ///< that the body follows
};

}  // namespace screed
