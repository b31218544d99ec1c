// What a robot is driven in when a network stands in for the physics: motors and battery as they
// are, below them tracks or wheels whose motion the network turns into the robot's. The firmware,
// its sensors and its radio notice nothing.
//
// The terrain supports and inclines the robot. With a network of the terrain (nn/terrain) the
// wheels change it, a stride of five frames at a time; without one it stays as it is.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/drive_shaft.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/plant_options.h"
#include "host_sim/standin/driving_state.h"
#include "nn/surrogate/surrogate.h"
#include "nn/terrain/terrain_network.h"

namespace screed::nn {

class SurrogatePlant : public Environment {
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

  void step(const std::array<double, 2>& duty_ratio) override;
  ImuTruth motion() const override;
  void lay_on_side() override;

  int steps_per_tick() const override { return kStepsPerTick; }
  uint64_t steps() const override { return steps_; }
  double time_s() const override;
  const HeightField& terrain() const override { return ground_; }
  bool is_deformable() const override { return static_cast<bool>(ground_change_); }
  const VehicleState& vehicle() const override { return vehicle_; }
  const std::array<int64_t, 2>& wrap_counts() const override { return wrap_counts_; }
  Eigen::Vector3d unwrapped_position() const override;
  const Battery& battery() const override { return battery_; }

  /// Where the robot is, positions as travelled.
  PlanarPose pose() const { return robot_.pose(0); }

 private:
  static constexpr int kStepsPerTick = 10;

  /// The robot's body as the network's pose and the ground under it say.
  struct BodyPose {
    Attitude attitude{};
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of Body's origin, as travelled
    /// Of the attitude, worked out once: much asks for it in every frame.
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  };

  class Body : public VehicleState {
   public:
    explicit Body(const SurrogatePlant& plant) : plant_(plant) {}
    ChassisState chassis() const override;
    double track_speed_m_per_s(Side side) const override;
    double shaft_angle_rad(Side side) const override;
    double current_a(Side side) const override;
    double wheel_radius_m(Side side) const override;
    double load_n(Side side) const override;
    double sinkage_m(Side /*side*/) const override { return 0.0; }
    double ground_speed_m_per_s(Side side) const override;

   private:
    const SurrogatePlant& plant_;
  };

  /// The ground's push against each track, as torques on their shafts.
  std::array<double, 2> resistance() const;
  void end_frame();
  /// The rectangle round the robot from above.
  Eigen::AlignedBox2d outline() const;
  /// A wall stops what of the frame's motion leads into it, and nothing else: it does not turn the
  /// robot and has no friction.
  void stop_at_walls();
  /// Of the ground as it is now below the robot's pose; the next frame begins on it.
  void find_support();
  void turn_to(const Attitude& attitude);
  void set_at_rest();
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
  Eigen::Vector3d imu_position_;
  Surrogate robot_;
  std::array<DriveShaft, 2> shafts_;
  std::array<double, 2> angle_offset_rad_{};
  Battery battery_;
  Body vehicle_;
  bool on_side_ = false;
  uint64_t steps_ = 0;
  std::array<int64_t, 2> wrap_counts_ = {0, 0};

  Support support_{};
  BodyPose now_;
  double sin_pitch_ = 0.0;  ///< of now_
  BodyPose before_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();      ///< of Body's origin
  Eigen::Vector3d imu_velocity_ = Eigen::Vector3d::Zero();  ///< over the last frame
  Eigen::Vector3d imu_velocity_before_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_body_ = Eigen::Vector3d::Zero();
};

}  // namespace screed::nn
