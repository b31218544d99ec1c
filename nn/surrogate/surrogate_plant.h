// What a robot is driven in when a network stands in for the physics: motors and battery as they
// are, below them tracks whose motion the network turns into the robot's. The firmware, its sensors
// and its radio notice nothing.
//
// The ground bears and inclines the robot. With a network of what bears tracks (nn/terrain) it
// gives way below them, a stride of five frames at a time; without one it stays as it is.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/drive_shaft.h"
#include "host_sim/physics/world/plant.h"
#include "host_sim/physics/world/surroundings.h"
#include "nn/surrogate/surrogate.h"
#include "nn/terrain/track_ground.h"

namespace screed::nn {

/// A robot in the middle of a drive.
struct DrivingState {
  PlanarPose pose;
  FrameMotion last;
  FrameMotion before_last;
  std::array<double, 2> track_speed_m_per_s{};
  std::array<double, 2> shaft_angle_rad{};
  Battery battery;
};

class SurrogatePlant : public Surroundings {
 public:
  /// Of the options those of the physics do not count. Throws InputError when the ground is not
  /// soil, the robot has no tracks, or the model cannot be used here.
  SurrogatePlant(HeightField terrain, const Assembly& model, const PlantOptions& options,
                 const Model& network);
  /// The same with another stand-in, of one robot.
  SurrogatePlant(HeightField terrain, const Assembly& model, const PlantOptions& options,
                 Surrogate robot);

  /// From now on the tracks press the ground, by this network or, when it is null, in closed form.
  /// `sunk`: by how much earlier passes did, where that is known (TrackGround::sunk).
  void let_give_way(std::shared_ptr<const BearingNetwork> network,
                    const HeightField* sunk = nullptr);

  /// Goes on from there.
  void set_state(const DrivingState& state);

  void step(const std::array<double, 2>& share) override;
  ImuTruth motion() const override;
  void lay_on_side() override;

  int steps_per_tick() const override { return kStepsPerTick; }
  uint64_t steps() const override { return steps_; }
  double time_s() const override;
  const HeightField& terrain() const override { return ground(); }
  const SoilBed* soil() const override { return nullptr; }
  const ParticleBed* particles() const override { return nullptr; }
  bool ground_is_loose() const override { return true; }
  const VehicleState& vehicle() const override { return vehicle_; }
  const std::array<int64_t, 2>& beds_passed() const override { return beds_passed_; }
  Eigen::Vector3d place_travelled() const override;
  const Battery& battery() const override { return battery_; }

  /// The ground below the tracks; null while it does not give way.
  const TrackGround* pressed() const { return pressed_.get(); }
  /// Where the robot is, places as travelled.
  PlanarPose pose() const { return robot_.pose(0); }
  FrameMotion last_motion() const { return robot_.motion(0); }

 private:
  static constexpr int kStepsPerTick = 10;

  /// The robot's body as the network's pose and the ground under it say.
  struct Stance {
    Attitude attitude{};
    Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< of Body's origin, as travelled
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

  /// The ground's push against a track, as a torque on its shaft.
  double resistance(Side side) const;
  void end_frame();
  Stance stance_on_ground() const;
  void stand_still();
  const HeightField& ground() const { return pressed_ ? pressed_->surface() : ground_; }
  void press_ground();

  HeightField ground_;  ///< unless pressed_ holds it
  SoilParameters soil_;
  TrackGeometry tracks_;
  std::unique_ptr<TrackGround> pressed_;
  std::shared_ptr<const BearingNetwork> bearing_;
  PlanarPose stride_begin_;  ///< since the ground was last pressed
  std::array<double, 2> stride_tracks_m_{};
  std::uint64_t stride_frames_ = 0;
  std::uint64_t still_strides_ = 0;
  SupportGeometry geometry_;
  double standing_height_m_ = 0.0;
  double tread_m_ = 0.0;
  double mass_kg_ = 0.0;
  Eigen::Vector3d imu_position_;
  Surrogate robot_;
  std::array<DriveShaft, 2> shafts_;
  std::array<double, 2> angle_offset_rad_{};
  Battery battery_;
  Body vehicle_;
  bool on_side_ = false;
  uint64_t steps_ = 0;
  std::array<int64_t, 2> beds_passed_ = {0, 0};

  Stance now_;
  Stance before_;
  Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();      ///< of Body's origin
  Eigen::Vector3d imu_velocity_ = Eigen::Vector3d::Zero();  ///< over the last frame
  Eigen::Vector3d imu_velocity_before_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate_body_ = Eigen::Vector3d::Zero();
};

}  // namespace screed::nn
