// One robot's bodies, motors and battery.
#include "host_sim/physics/world/plant_robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/gravity.h"
#include "host_sim/physics/world/wall_clearance.h"

namespace screed {
namespace {

Eigen::Vector3d imu_position(const Assembly& model) {
  const int imu = model.imu;
  return imu < 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                 : Eigen::Vector3d(model.bodies[static_cast<size_t>(imu)].pose.translation());
}

}  // namespace

PlantRobot::PlantRobot(const Environment& plant, const Terrain& terrain, OdeWorld& ode,
                       const Assembly& model, const VehicleOptions& options, const Battery& battery)
    : plant_(plant),
      terrain_(terrain),
      vehicle_(ode, model, options),
      battery_(battery),
      imu_position_(imu_position(model)),
      imu_history_(static_cast<size_t>(plant.steps_per_tick()) + 1) {}

std::array<double, 2> PlantRobot::motor_voltage(const DutyRatio& duty_ratio) {
  // Terminal voltage and motor currents are those of the step before: the battery is one step late.
  std::array<double, 2> voltage{};
  current_a_ = 0.0;
  for (const Side side : {kLeft, kRight}) {
    const double of_side = duty_ratio[static_cast<size_t>(side)];
    voltage[static_cast<size_t>(side)] = of_side * battery_.terminal_v;
    // The driver's off phase brakes: current then circulates in the motor, and never flows back
    // into the battery.
    current_a_ += std::max(0.0, of_side * vehicle_.current_a(side));
  }
  return voltage;
}

void PlantRobot::end_step(double step_s) {
  battery_.step(current_a_, step_s);
  newest_ = (newest_ + 1) % imu_history_.size();
  const ChassisState chassis = vehicle_.chassis();
  imu_history_[newest_] = {imu_velocity(chassis), chassis.omega_body};
}

void PlantRobot::begin_motion_here() {
  reset_motion_history(imu_velocity(vehicle_.chassis()));
}

void PlantRobot::wrap_around() {
  const BedBounds bed = terrain_.bounds();
  if (bed.edge != BedEdge::kWrapped) return;
  const Eigen::Vector3d at = vehicle_.chassis().pose.translation();
  const auto beds_off = [](double coordinate, double size) {
    // Half open, so that a robot on the very edge stays where it is put.
    return coordinate >= -0.5 * size && coordinate < 0.5 * size
               ? 0.0
               : std::floor(coordinate / size + 0.5);
  };
  const double east = beds_off(at.x(), bed.width_m);
  const double north = beds_off(at.y(), bed.depth_m);
  if (east == 0.0 && north == 0.0) return;
  // A place that is no number stays: motion() says that the physics diverged.
  if (!std::isfinite(east) || !std::isfinite(north)) return;
  vehicle_.shift(-east * bed.width_m, -north * bed.depth_m);
  wrap_counts_[0] += static_cast<int64_t>(east);
  wrap_counts_[1] += static_cast<int64_t>(north);
}

Eigen::Vector3d PlantRobot::unwrapped_position() const {
  const BedBounds bed = terrain_.bounds();
  return vehicle_.chassis().pose.translation() +
         Eigen::Vector3d(static_cast<double>(wrap_counts_[0]) * bed.width_m,
                         static_cast<double>(wrap_counts_[1]) * bed.depth_m, 0.0);
}

Eigen::Vector3d PlantRobot::imu_velocity(const ChassisState& chassis) const {
  const Eigen::Matrix3d& rotation = chassis.pose.linear();
  return chassis.velocity + rotation * chassis.omega_body.cross(imu_position_);
}

void PlantRobot::reset_motion_history(const Eigen::Vector3d& velocity) {
  std::fill(imu_history_.begin(), imu_history_.end(), ImuState{velocity, Eigen::Vector3d::Zero()});
}

ImuTruth PlantRobot::motion() const {
  const ChassisState chassis = vehicle_.chassis();
  const ImuState& now = imu_history_[newest_];
  const Eigen::Matrix3d rotation = chassis.pose.linear();
  if (!now.velocity.allFinite() || !chassis.pose.translation().allFinite() ||
      now.velocity.norm() > 1000.0) {
    throw RunError("the physics diverged at " + std::to_string(plant_.time_s()) +
                   " s; a smaller [physics] step may help");
  }
  const size_t oldest = (newest_ + 1) % imu_history_.size();
  Eigen::Vector3d rate_sum = Eigen::Vector3d::Zero();
  for (size_t i = 1; i < imu_history_.size(); ++i) {
    rate_sum += imu_history_[(oldest + i) % imu_history_.size()].rate_body;
  }
  ImuTruth truth;
  truth.mean_rate_rad_per_s = rate_sum / plant_.steps_per_tick();
  truth.mean_specific_force =
      rotation.transpose() * ((now.velocity - imu_history_[oldest].velocity) / kTick_s +
                              kGravity_m_per_s2 * Eigen::Vector3d::UnitZ());
  truth.body_to_world = rotation;
  truth.altitude_m = chassis.pose.translation().z();
  return truth;
}

void PlantRobot::lay_on_side() {
  Eigen::Isometry3d pose = vehicle_.chassis().pose;
  Attitude attitude = attitude_of(pose.linear());
  attitude.roll = -std::numbers::pi / 2.0;
  attitude.pitch = 0.0;
  pose.linear() = rotation_from(attitude);
  vehicle_.place(pose);
  pose.translation().head<2>() += out_of_walls(terrain_.bounds(), vehicle_.outline());
  pose.translation().z() = vehicle_.resting_height(terrain_.surface(), pose.translation().x(),
                                                   pose.translation().y(), pose.linear());
  vehicle_.place(pose);
  // A hand, not an impact: the accelerometer sees the new attitude, no jerk.
  reset_motion_history(Eigen::Vector3d::Zero());
}

}  // namespace screed
