// What the robot is driven in, as physics: terrain, bodies, motors and battery, advanced a physics
// step at a time. Knows no clock but its own steps, no sensor counts and no firmware.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/gear_motor.h"
#include "host_sim/physics/vehicle/ode_world.h"
#include "host_sim/physics/vehicle/vehicle.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/imu_truth.h"
#include "host_sim/physics/world/terrain_factory.h"

namespace screed {

struct StartPose {
  double x_m = 0.0;
  double y_m = 0.0;
  /// Of the chassis' origin; without it the robot is placed on the terrain and settles.
  std::optional<double> z_m;
  Attitude attitude = {0.0, 0.0, 0.0};
};

struct PlantOptions : TerrainOptions {
  double physics_step_s = 0.001;  ///< divides the control tick of 10 ms
  StartPose start;
  VehicleOptions vehicle;
  Battery battery;
};

class Plant : public Environment {
 public:
  /// A robot on this terrain. Throws InputError when the options do not fit together. Reports the
  /// task "settling the robot" to options.progress.
  Plant(std::unique_ptr<Terrain> terrain, const Assembly& model, const PlantOptions& options);
  /// The same on terrain of the kind that the options name, with this surface.
  Plant(HeightField surface, const Assembly& model, const PlantOptions& options);

  void step(const std::array<double, 2>& duty_ratio) override;
  ImuTruth motion() const override;
  void lay_on_side() override;

  int steps_per_tick() const override { return steps_per_tick_; }
  double step_s() const { return step_s_; }
  uint64_t steps() const override { return steps_; }
  double time_s() const override;
  const HeightField& terrain() const override { return terrain_->surface(); }
  bool is_deformable() const override { return terrain_->is_deformable(); }
  VolumeBalance volume_balance() const override { return terrain_->balance(); }
  TerrainWork terrain_work() const override { return terrain_->work(); }
  SphereSet spheres() const override { return terrain_->spheres(); }
  const Vehicle& vehicle() const override { return vehicle_; }
  const std::array<int64_t, 2>& wrap_counts() const override { return wrap_counts_; }
  Eigen::Vector3d unwrapped_position() const override;
  const Battery& battery() const override { return battery_; }

 private:
  struct ImuState {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();   ///< of the IMU, world frame, m/s
    Eigen::Vector3d rate_body = Eigen::Vector3d::Zero();  ///< rad/s
  };

  /// Lets the robot come to rest on the ground before the clock starts, as one that stood there
  /// when it was switched on.
  void settle(const TaskProgress& progress);
  /// Teleports the robot when it has left the bed.
  void wrap_around();
  /// Forces, integration and terrain of one physics step.
  void step_bodies(const std::array<double, 2>& motor_voltage);
  Eigen::Vector3d imu_velocity(const ChassisState& chassis) const;
  /// The history says: the IMU has been moving at this velocity all the time.
  void reset_motion_history(const Eigen::Vector3d& velocity);

  double step_s_;
  int steps_per_tick_;
  std::unique_ptr<Terrain> terrain_;
  int substeps_;  // in one physics step, as short as the terrain needs them
  OdeWorld ode_;
  Vehicle vehicle_;
  Battery battery_;
  Eigen::Vector3d imu_position_;  ///< in the frame of the chassis
  uint64_t steps_ = 0;
  std::array<int64_t, 2> wrap_counts_ = {0, 0};
  /// A ring buffer of the last tick's steps and the one before; the newest stands at newest_.
  std::vector<ImuState> imu_history_;
  size_t newest_ = 0;
};

}  // namespace screed
