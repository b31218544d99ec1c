// What a robot is driven in when a network stands in for the physics: motors and battery as they
// are, below them tracks or wheels whose motion the network turns into the robot's. The firmware,
// its sensors and its radio notice nothing.
//
// The world and its one robot are one object. The terrain supports and inclines the robot. With a
// network of the terrain (nn/terrain) the wheels change it, a stride of five frames at a time;
// without one it stays as it is.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/plant_options.h"
#include "host_sim/standin/planar_pose.h"
#include "host_sim/standin/planar_robot.h"
#include "nn/surrogate/surrogate.h"
#include "nn/terrain/terrain_network.h"

namespace screed::nn {

class SurrogatePlant : public Environment, public PlanarRobot {
 public:
  /// Of the options those of the physics do not count. Throws InputError when there are several
  /// robots or one stands in a wall, or the model cannot be used here.
  SurrogatePlant(HeightField terrain, const Assembly& model, const PlantOptions& options,
                 const Model& network);
  /// The same with another surrogate, of one robot.
  SurrogatePlant(HeightField terrain, const Assembly& model, const PlantOptions& options,
                 Surrogate robot);

  /// From now on this changes the ground, stride by stride.
  void change_ground_by(GroundChange change) { ground_change_ = std::move(change); }

  /// Goes on from there.
  void set_state(const DrivingState& state);

  // Environment
  void step(std::span<const DutyRatio> duty_ratios) override;
  std::size_t robots() const override { return 1; }
  PlanarRobot& robot(std::size_t /*number*/) override { return *this; }
  const PlanarRobot& robot(std::size_t /*number*/) const override { return *this; }
  int steps_per_tick() const override { return kStepsPerTick; }
  uint64_t steps() const override { return steps_; }
  const HeightField& terrain() const override { return ground_; }
  bool is_deformable() const override { return static_cast<bool>(ground_change_); }

  // VehicleState
  double load_n(Side side) const override;
  double sinkage_m(Side /*side*/) const override { return 0.0; }

  /// Where the robot is, positions as travelled.
  PlanarPose pose() const { return robot_.pose(0); }

 private:
  static constexpr int kStepsPerTick = 10;

  /// The ground's push against each track, as torques on their shafts.
  std::array<double, 2> resistance() const;
  void end_frame();
  /// The rectangle round the robot from above.
  Eigen::AlignedBox2d outline() const;
  /// A wall stops what of the frame's motion leads into it, and nothing else: it does not turn the
  /// robot and has no friction.
  void stop_at_walls();
  BodyPose pose_of_body(double roll, double pitch, double height_m);
  /// Of the ground as it is now below the robot's pose; the next frame begins on it.
  void find_support();
  void begin_stride(const PlanarPose& pose);
  void end_stride();

  HeightField ground_;
  GroundChange ground_change_;
  PlanarPose stride_begin_;
  std::array<double, 2> stride_tracks_m_{};
  std::uint64_t stride_frames_ = 0;
  SupportGeometry geometry_;
  double standing_height_m_ = 0.0;
  double tread_m_ = 0.0;
  double mass_kg_ = 0.0;
  Eigen::AlignedBox2d body_outline_;  ///< from above, in the frame of the chassis
  Surrogate robot_;
  uint64_t steps_ = 0;
  Support support_{};
  double sin_pitch_ = 0.0;  ///< of the body
};

}  // namespace screed::nn
