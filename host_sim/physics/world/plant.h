// The world of ODE: its robots, and how they and the terrain are stepped together.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/drive_train.h"
#include "host_sim/physics/vehicle/ode_world.h"
#include "host_sim/physics/vehicle/robot_contact.h"
#include "host_sim/physics/vehicle/vehicle.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/plant_options.h"

namespace screed {

// One of the robots in a plant: its bodies, motors and battery, and the motion that its IMU will
// have measured.

class PlantRobot : public RobotView {
 public:
  /// `plant` is what it is in, and says what concerns all robots. It, its terrain and `ode` must
  /// outlive the robot.
  PlantRobot(const Environment& plant, const Terrain& terrain, OdeWorld& ode, const Assembly& model,
             const VehicleOptions& options, const Battery& battery);

  /// What the motors get in a step with this duty. Counts the battery's current.
  std::array<double, 2> motor_voltage(const DutyRatio& duty_ratio);
  /// Teleports the robot when it has left a bed that wraps around.
  void wrap_around();
  /// From here wrap_counts() counts.
  void reset_wrap_counts() { wrap_counts_ = {0, 0}; }
  /// Ends a step, after the bodies have moved.
  void end_step(double step_s);
  /// The history says: the IMU has been moving as it does now, without turning, all the time.
  void begin_motion_here();

  ImuTruth motion() const override;
  void lay_on_side() override;
  Vehicle& vehicle() { return vehicle_; }
  const Vehicle& vehicle() const override { return vehicle_; }
  const std::array<int64_t, 2>& wrap_counts() const override { return wrap_counts_; }
  Eigen::Vector3d unwrapped_position() const override;
  const Battery& battery() const override { return battery_; }
  /// Of its motion and height, less what motors and hands have given it, J.
  double unpaid_energy_j() const {
    return vehicle_.energy_j() - vehicle_.motor_work_j() - given_j_;
  }

 private:
  struct ImuState {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();   ///< of the IMU, world frame, m/s
    Eigen::Vector3d rate_body = Eigen::Vector3d::Zero();  ///< rad/s
  };

  Eigen::Vector3d imu_velocity(const ChassisState& chassis) const;
  void reset_motion_history(const Eigen::Vector3d& velocity);

  const Environment& plant_;
  const Terrain& terrain_;
  Vehicle vehicle_;
  Battery battery_;
  double current_a_ = 0.0;        ///< from the battery in this step
  double given_j_ = 0.0;          ///< by hands since the start
  Eigen::Vector3d imu_position_;  ///< in the frame of the chassis
  std::array<int64_t, 2> wrap_counts_ = {0, 0};
  /// A ring buffer of the last tick's steps and the one before; the newest stands at newest_.
  std::vector<ImuState> imu_history_;
  size_t newest_ = 0;
};

// What robots are driven in, as physics: one terrain, and bodies, motors and battery of each robot
// (plant.h), advanced a physics step at a time. Knows no clock but its own steps, no sensor
// counts and no firmware.

class Plant : public Environment {
 public:
  /// Robots on this terrain. Throws InputError when the options do not fit together. Reports the
  /// task "settling the robot" to options.progress.
  Plant(std::unique_ptr<Terrain> terrain, const Assembly& model, const PlantOptions& options);
  /// The same on terrain of the kind that the options name, with this surface.
  Plant(HeightField surface, const Assembly& model, const PlantOptions& options);
  Plant(const Plant&) = delete;
  Plant& operator=(const Plant&) = delete;

  void step(std::span<const DutyRatio> duty_ratios) override;
  size_t robots() const override { return robots_.size(); }
  PlantRobot& robot(size_t number) override { return *robots_[number]; }
  const PlantRobot& robot(size_t number) const override { return *robots_[number]; }

  int steps_per_tick() const override { return steps_per_tick_; }
  double step_s() const { return step_s_; }
  /// In how many parts the next step is taken: shorter ones where terrain needs them, and while
  /// robots touch or are about to.
  int substeps() const;
  uint64_t steps() const override { return steps_; }
  const HeightField& terrain() const override { return terrain_->surface(); }
  bool is_deformable() const override { return terrain_->is_deformable(); }
  VolumeBalance volume_balance() const override { return terrain_->balance(); }
  TerrainWork terrain_work() const override { return terrain_->work(); }
  SphereSet spheres() const override { return terrain_->spheres(); }

 private:
  void add_robot(const Assembly& model, const PlantOptions& options);
  void check_step() const;
  /// Puts a robot, one of `starts`, where it starts.
  void place(PlantRobot& robot, const StartPose& start, size_t starts);
  /// Throws InputError when the last robot stands in another one.
  void check_apart(size_t starts);
  /// Lets the robots come to rest on the ground before the clock starts, as ones that stood there
  /// when they were switched on.
  void settle(const TaskProgress& progress);
  /// From a robot to its copy that is nearest to another one; zero on a bed that does not wrap
  /// around.
  Eigen::Vector3d to_near_copy(const PlantRobot& robot, const PlantRobot& from) const;
  void collide(double dt);
  /// Forces, integration and terrain of one physics step, with voltages_.
  void step_bodies();
  double unpaid_energy_j() const;
  /// Throws RunError when the robots have energy that nobody gave them.
  void check_energy();

  double step_s_;
  int steps_per_tick_;
  std::unique_ptr<Terrain> terrain_;
  int substeps_;          // in one physics step, as short as the terrain needs them
  int meeting_substeps_;  // the same while robots touch or are about to
  OdeWorld ode_;
  RobotContact contact_;
  std::vector<std::unique_ptr<PlantRobot>> robots_;
  std::vector<std::array<double, 2>> voltages_;  // of each robot's motors in this step
  double mass_kg_ = 0.0;                         // of all robots
  double most_energy_j_ = 0.0;  // that the robots can have without having been given it
  uint64_t steps_ = 0;
};

}  // namespace screed
