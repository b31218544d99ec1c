// The stand-in: robots on belts over soil, in closed form.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host_sim/core/rotation.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/plant_options.h"
#include "host_sim/standin/belt_ground.h"
#include "host_sim/standin/belt_motion.h"
#include "host_sim/standin/planar_pose.h"
#include "host_sim/standin/planar_robot.h"

namespace screed {

// One robot of the stand-in's world: motors and battery as they are, belts that move it, a body
// that lies on the ground as its belts do.

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

// The world of robots on belts in closed form, where the physics is too slow: the same motors and
// batteries, a ground of the same soil, robots that stand on it without dynamics. The firmware, its
// sensors and its radio notice nothing. docs/standin.md says how far it can be trusted.

/// Coarsest cells of the ground on which belts 30 mm wide find their way, m: what a run in the
/// stand-in takes where an experiment has finer ones.
inline constexpr double kStandInCell_m = 0.02;

class StandInPlant final : public Environment {
 public:
  /// Of the options the step, frictions, start heights and attitudes do not count. Throws
  /// InputError when the ground is not soil, the robot has no belts, stands in a wall or in another
  /// robot.
  StandInPlant(const HeightField& terrain, const Assembly& model, const PlantOptions& options,
               const BeltFit& fit = {});

  /// The first robot, which stands there, goes on from there.
  void set_state(const DrivingState& state) { robots_[0]->set_state(state); }
  PlanarPose pose() const { return robots_[0]->pose(); }
  /// A frame in which the first robot's belts run at these speeds, m/s, left and right, whatever
  /// drives them.
  void step_frame(const std::array<double, 2>& belts_m_per_s);
  /// The same where something else moves the robot: to this pose, by this motion.
  void follow_frame(const std::array<double, 2>& belts_m_per_s, const PlanarPose& pose,
                    const FrameMotion& motion);

  void step(std::span<const DutyRatio> duty_ratios) override;
  std::size_t robots() const override { return robots_.size(); }
  StandInRobot& robot(std::size_t number) override { return *robots_[number]; }
  const StandInRobot& robot(std::size_t number) const override { return *robots_[number]; }

  int steps_per_tick() const override { return kStepsPerTick; }
  uint64_t steps() const override { return steps_; }
  const HeightField& terrain() const override { return ground_.surface(); }
  bool is_deformable() const override { return true; }
  VolumeBalance volume_balance() const override { return ground_.balance(); }

 private:
  static constexpr int kStepsPerTick = 5;  // of motors and battery

  void check_apart(const StartPose& start, size_t starts) const;
  void push_from_walls(StandInRobot& robot) const;
  void push_apart(StandInRobot& robot, StandInRobot& other) const;
  void end_frame();
  void end_stride();

  BeltGround ground_;
  std::vector<std::unique_ptr<StandInRobot>> robots_;
  uint64_t steps_ = 0;
  int stride_frames_ = 0;
};

}  // namespace screed
