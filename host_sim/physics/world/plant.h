// What robots are driven in, as physics: one terrain, and bodies, motors and battery of each robot
// (plant_robot.h), advanced a physics step at a time. Knows no clock but its own steps, no sensor
// counts and no firmware.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/ode_world.h"
#include "host_sim/physics/vehicle/robot_contact.h"
#include "host_sim/physics/vehicle/vehicle.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/imu_truth.h"
#include "host_sim/physics/world/plant_options.h"
#include "host_sim/physics/world/plant_robot.h"

namespace screed {

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
  /// Puts a robot where it starts.
  void place(PlantRobot& robot, const StartPose& start);
  /// Throws InputError when the last robot stands in another one.
  void check_apart();
  /// Lets the robots come to rest on the ground before the clock starts, as ones that stood there
  /// when they were switched on.
  void settle(const TaskProgress& progress);
  /// From a robot to its copy that is nearest to another one; zero on a bed that does not wrap
  /// around.
  Eigen::Vector3d to_near_copy(const PlantRobot& robot, const PlantRobot& from) const;
  void collide(double dt);
  /// Forces, integration and terrain of one physics step, with voltages_.
  void step_bodies();

  double step_s_;
  int steps_per_tick_;
  std::unique_ptr<Terrain> terrain_;
  int substeps_;          // in one physics step, as short as the terrain needs them
  int meeting_substeps_;  // the same while robots touch or are about to
  OdeWorld ode_;
  RobotContact contact_;
  std::vector<std::unique_ptr<PlantRobot>> robots_;
  std::vector<std::array<double, 2>> voltages_;  // of each robot's motors in this step
  uint64_t steps_ = 0;
};

}  // namespace screed
