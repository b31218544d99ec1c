// The robots of the plant, and its step.
#include "host_sim/physics/world/plant.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/finite_number.h"
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
  // A place that is no number stays: Plant says that the physics diverged.
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
  const double before = vehicle_.energy_j();
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
  given_j_ += vehicle_.energy_j() - before;
  // A hand, not an impact: the accelerometer sees the new attitude, no jerk.
  reset_motion_history(Eigen::Vector3d::Zero());
}

// Terrain, bodies, motors and batteries.

namespace {
// The motion of chassis and wheels enters a chain a step late (chain_track.h).
constexpr double kLongestChainStep_s = 0.001;

int steps_in_tick(double physics_step_s) {
  const double steps = kTick_s / physics_step_s;
  const double whole = std::round(steps);
  if (!(whole >= 1.0) || std::abs(steps - whole) > 1e-6) {
    throw InputError("[physics] step = " + shortest(physics_step_s) +
                     " s; it must divide the control tick of 0.01 s into whole steps");
  }
  return static_cast<int>(whole);
}

std::string diverged(double time_s, double gain_j) {
  char line[200];
  std::snprintf(
      line, sizeof line,
      "the physics diverged at %.3f s: %.3g J of motion that nothing has given; a smaller "
      "[physics] step or less stiff ground may help",
      time_s, gain_j);
  return line;
}

/// From how far on robots are about to touch. What contact_ sees is a step old when it is asked,
/// and counts for one: two steps in which they come nearer by no more than 1.5 m/s, and 5 mm since
/// it sees them point by point.
double notice_m(double step_s) {
  constexpr double kFastest_m_per_s = 1.5;
  constexpr double kPoints_m = 0.005;
  return 2.0 * kFastest_m_per_s * step_s + kPoints_m;
}

/// To the copy of a coordinate that is nearest to another one, on a bed that wraps around.
double to_nearest_copy(double coordinate, double from, double size_m) {
  return -size_m * std::round((coordinate - from) / size_m);
}

}  // namespace

Plant::Plant(HeightField surface, const Assembly& model, const PlantOptions& options)
    : Plant(build_terrain(std::move(surface), options), model, options) {}

Plant::Plant(std::unique_ptr<Terrain> terrain, const Assembly& model, const PlantOptions& options)
    : step_s_(options.physics_step_s),
      steps_per_tick_(steps_in_tick(options.physics_step_s)),
      terrain_(std::move(terrain)),
      substeps_(
          std::max(1, static_cast<int>(std::ceil(step_s_ / terrain_->longest_step_s() - 1e-9)))),
      meeting_substeps_(std::max(
          substeps_, static_cast<int>(std::ceil(step_s_ / RobotContact::kLongestStep_s - 1e-9)))),
      contact_(options.robot_friction, notice_m(step_s_)) {
  for (const StartPose& start : options.starts) {
    add_robot(model, options);
    check_step();
    place(*robots_.back(), start, options.starts.size());
    check_apart(options.starts.size());
  }
  for (const auto& robot : robots_) mass_kg_ += robot->vehicle().mass_kg();
  most_energy_j_ = unpaid_energy_j();
  if (!options.starts[0].z_m.has_value()) settle(options.progress);
}

void Plant::add_robot(const Assembly& model, const PlantOptions& options) {
  robots_.push_back(std::make_unique<PlantRobot>(*this, *terrain_, ode_, model, options.vehicle,
                                                 options.battery));
  voltages_.push_back({0.0, 0.0});
}

void Plant::check_step() const {
  if (robots_.back()->vehicle().chain(kLeft) != nullptr && step_s_ > kLongestChainStep_s + 1e-12) {
    throw InputError("[physics] step = " + shortest(step_s_) +
                     " s; with [vehicle] track_model = chain at most 0.001 s is allowed");
  }
}

void Plant::place(PlantRobot& robot, const StartPose& start, size_t starts) {
  Vehicle& vehicle = robot.vehicle();
  const Eigen::Matrix3d rotation = rotation_from(start.attitude);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation;
  const double resting =
      vehicle.resting_height(terrain_->surface(), start.x_m, start.y_m, rotation);
  pose.translation() << start.x_m, start.y_m, start.z_m.value_or(resting);
  if (start.z_m.has_value() && *start.z_m < resting - 0.01) {
    throw InputError("[vehicle] z = " + std::to_string(*start.z_m) +
                     " m puts the robot into the ground; at this place it must be " +
                     std::to_string(resting) + " or more (leave z out to set the robot down)");
  }
  vehicle.place(pose);
  check_between_walls(terrain_->bounds(), vehicle.outline(), {start.x_m, start.y_m},
                      robots_.size() - 1, starts);
  robot.wrap_around();
  robot.reset_wrap_counts();
}

void Plant::check_apart(size_t starts) {
  PlantRobot& last = *robots_.back();
  for (size_t i = 0; i + 1 < robots_.size(); ++i) {
    PlantRobot& other = *robots_[i];
    if (last.vehicle().depth_in(other.vehicle(), to_near_copy(other, last), contact_) == 0.0) {
      continue;
    }
    refuse_overlap(i, robots_.size() - 1, starts);
  }
}

Eigen::Vector3d Plant::to_near_copy(const PlantRobot& robot, const PlantRobot& from) const {
  const BedBounds bed = terrain_->bounds();
  if (bed.edge != BedEdge::kWrapped) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d at = robot.vehicle().chassis().pose.translation();
  const Eigen::Vector3d origin = from.vehicle().chassis().pose.translation();
  return {to_nearest_copy(at.x(), origin.x(), bed.width_m),
          to_nearest_copy(at.y(), origin.y(), bed.depth_m), 0.0};
}

void Plant::settle(const TaskProgress& progress) {
  constexpr double kSettle_s = 1.5;
  const auto steps = static_cast<int>(std::lround(kSettle_s / step_s_));
  for (int i = 0; i < steps; ++i) {
    report_progress(progress, "settling the robot", static_cast<double>(i) / steps);
    step_bodies();
  }
  for (const auto& robot : robots_) robot->begin_motion_here();
}

void Plant::collide(double dt) {
  for (size_t i = 0; i < robots_.size(); ++i) {
    for (size_t j = i + 1; j < robots_.size(); ++j) {
      robots_[i]->vehicle().collide(robots_[j]->vehicle(), to_near_copy(*robots_[j], *robots_[i]),
                                    dt, contact_);
    }
  }
}

int Plant::substeps() const {
  return contact_.gap_m() < contact_.notice_m() ? meeting_substeps_ : substeps_;
}

void Plant::step_bodies() {
  const int parts = substeps();
  contact_.forget_gap();
  const double dt = step_s_ / parts;
  for (int i = 0; i < parts; ++i) {
    collide(dt);
    for (size_t robot = 0; robot < robots_.size(); ++robot)
      robots_[robot]->vehicle().apply_forces(*terrain_, voltages_[robot], dt);
    terrain_->end_step(dt);
    ode_.step(dt);
  }
  for (const auto& robot : robots_) robot->wrap_around();
  check_energy();
}

double Plant::unpaid_energy_j() const {
  double energy = 0.0;
  for (const auto& robot : robots_) energy += robot->unpaid_energy_j();
  return energy;
}

// Ground and walls only take energy, and give back what their springs have kept for a moment. So
// what nobody has given can only fall, and once it has been low for longer than a robot bounces, it
// stays low.
void Plant::check_energy() {
  constexpr double kBounce_s = 0.5;
  constexpr double kHeight_m = 0.1;  // by which moving ground may lift a robot
  const double gain = unpaid_energy_j() - most_energy_j_;
  if (!(gain < kHeight_m * kGravity_m_per_s2 * mass_kg_)) {
    throw RunError(diverged(time_s(), gain));
  }
  if (gain < 0.0) most_energy_j_ += gain * std::min(1.0, step_s_ / kBounce_s);
}

void Plant::step(std::span<const DutyRatio> duty_ratios) {
  for (size_t i = 0; i < robots_.size(); ++i)
    voltages_[i] = robots_[i]->motor_voltage(duty_ratios[i]);
  step_bodies();
  for (const auto& robot : robots_) robot->end_step(step_s_);
  ++steps_;
}

}  // namespace screed
