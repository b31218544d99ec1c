// One of the robots in a plant: its bodies, motors and battery, and the motion that its IMU will
// have measured.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/battery.h"
#include "host_sim/physics/vehicle/ode_world.h"
#include "host_sim/physics/vehicle/vehicle.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/physics/world/imu_truth.h"

namespace screed {

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
  Eigen::Vector3d imu_position_;  ///< in the frame of the chassis
  std::array<int64_t, 2> wrap_counts_ = {0, 0};
  /// A ring buffer of the last tick's steps and the one before; the newest stands at newest_.
  std::vector<ImuState> imu_history_;
  size_t newest_ = 0;
};

}  // namespace screed
