// Terrain, bodies, motors and batteries.
#include "host_sim/physics/world/plant.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/physics/world/wall_clearance.h"

namespace screed {
namespace {
// The motion of chassis and wheels enters a chain a step late (chain_track.h).
constexpr double kLongestChainStep_s = 0.001;

int steps_in_tick(double physics_step_s) {
  const double steps = kTick_s / physics_step_s;
  const double whole = std::round(steps);
  if (!(whole >= 1.0) || std::abs(steps - whole) > 1e-6) {
    throw InputError("[physics] step = " + std::to_string(physics_step_s) +
                     " s; it must divide the control tick of 0.01 s into whole steps");
  }
  return static_cast<int>(whole);
}

/// To the copy of a coordinate that is nearest to another one, on a bed that wraps around.
/// From how far on robots are about to touch. What contact_ sees is a step old when it is asked,
/// and counts for one: two steps in which they come nearer by no more than 1.5 m/s, and 5 mm since
/// it sees them point by point.
double notice_m(double step_s) {
  constexpr double kFastest_m_per_s = 1.5;
  constexpr double kPoints_m = 0.005;
  return 2.0 * kFastest_m_per_s * step_s + kPoints_m;
}

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
      substeps_(std::max(1, static_cast<int>(std::ceil(step_s_ / terrain_->longest_step_s())))),
      meeting_substeps_(std::max(
          substeps_, static_cast<int>(std::ceil(step_s_ / RobotContact::kLongestStep_s - 1e-9)))),
      contact_(options.robot_friction, notice_m(step_s_)) {
  for (const StartPose& start : options.starts) {
    add_robot(model, options);
    check_step();
    place(*robots_.back(), start);
    check_apart();
  }
  if (!options.starts[0].z_m.has_value()) settle(options.progress);
}

void Plant::add_robot(const Assembly& model, const PlantOptions& options) {
  robots_.push_back(std::make_unique<PlantRobot>(*this, *terrain_, ode_, model, options.vehicle,
                                                 options.battery));
  voltages_.push_back({0.0, 0.0});
}

void Plant::check_step() const {
  if (robots_.back()->vehicle().chain(kLeft) != nullptr && step_s_ > kLongestChainStep_s + 1e-12) {
    throw InputError("[physics] step = " + std::to_string(step_s_) +
                     " s; with [vehicle] track_model = chain at most 0.001 s is allowed");
  }
}

void Plant::place(PlantRobot& robot, const StartPose& start) {
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
  check_between_walls(terrain_->bounds(), vehicle.outline(), {start.x_m, start.y_m});
  robot.wrap_around();
  robot.reset_wrap_counts();
}

void Plant::check_apart() {
  PlantRobot& last = *robots_.back();
  for (size_t i = 0; i + 1 < robots_.size(); ++i) {
    PlantRobot& other = *robots_[i];
    if (last.vehicle().depth_in(other.vehicle(), to_near_copy(other, last), contact_) == 0.0) {
      continue;
    }
    throw InputError("[robots] robots " + std::to_string(i) + " and " +
                     std::to_string(robots_.size() - 1) +
                     " would stand in one another at the start; put them further apart");
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
}

void Plant::step(std::span<const DutyRatio> duty_ratios) {
  for (size_t i = 0; i < robots_.size(); ++i)
    voltages_[i] = robots_[i]->motor_voltage(duty_ratios[i]);
  step_bodies();
  for (const auto& robot : robots_) robot->end_step(step_s_);
  ++steps_;
}

}  // namespace screed
