// Clock, walls and contact between robots.
//
// Walls push the corners of a robot's outline out, another robot its outline, by a spring and a
// damper that never pull and without friction.
#include "host_sim/standin/standin_plant.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/vehicle_parts.h"
#include "host_sim/physics/world/wall_clearance.h"

namespace screed {
namespace {
// As stiff and as damped as a frame of 10 ms allows for a robot of a kilogram.
constexpr double kContact_n_per_m = 2000.0;
constexpr double kContact_n_s_per_m = 40.0;

double pushing(double depth_m, double parting_m_per_s) {
  return std::max(0.0, kContact_n_per_m * depth_m - kContact_n_s_per_m * parting_m_per_s);
}

BeltGround ground_of(const HeightField& terrain, const TrackGeometry& tracks,
                     const PlantOptions& options, const BeltFit& fit) {
  if (!options.soil.has_value()) {
    throw InputError(
        "the surrogate world knows soil alone: [map] model = scm, or another --hal than surrogate");
  }
  if (!options.vehicle.tracks || options.vehicle.track_model != TrackModel::kBelt) {
    throw InputError(
        "the surrogate world knows tracks alone: [vehicle] tracks = true and track_model = belt, "
        "or another --hal than surrogate");
  }
  return {terrain, *options.soil, tracks, options.starts.size(), fit};
}

StandInKind kind_of(const Assembly& model, const PlantOptions& options) {
  StandInKind kind;
  kind.tracks = track_geometry(model);
  kind.planar = {options.vehicle.motor, options.battery, kind.tracks.radius_m,
                 kind.tracks.half_tread_m};
  kind.outline = VehicleParts(model, options.vehicle).outline_at_rest();
  const int imu = model.body_index("Imu");
  if (imu >= 0) kind.planar.imu = model.bodies[static_cast<std::size_t>(imu)].pose.translation();
  return kind;
}

/// How two robots' outlines lie in each other.
struct Overlap {
  Eigen::Vector2d normal;  ///< unit length: the robot is out when it has gone `depth_m` that way
  double depth_m;
  Eigen::Vector2d place;  ///< where they touch, beside the robot
};

/// From one robot to the nearest copy of another, on a bed that wraps around.
Eigen::Vector2d nearest_way(const StandInRobot& robot, const StandInRobot& other,
                            const HeightField& ground) {
  Eigen::Vector2d way = other.middle() - robot.middle();
  if (ground.wrap()) {
    const Eigen::Array2d size(ground.x_max() - ground.x_min(), ground.y_max() - ground.y_min());
    way.array() -= size * (way.array() / size).round();
  }
  return way;
}

/// By the separating axis (S. Gottschalk, M. Lin, D. Manocha, SIGGRAPH 1996); nothing when there is
/// one.
std::optional<Overlap> overlap(const StandInRobot& robot, const StandInRobot& other,
                               const HeightField& ground) {
  const Eigen::Vector2d copy = robot.middle() + nearest_way(robot, other, ground) - other.middle();
  const auto own = robot.corners();
  auto others = other.corners();
  for (Eigen::Vector2d& corner : others) corner += copy;
  Overlap least{Eigen::Vector2d::Zero(), std::numeric_limits<double>::infinity(), {}};
  for (const Eigen::Matrix2d& turned : {robot.heading(), other.heading()}) {
    for (const int axis : {0, 1}) {
      const Eigen::Vector2d along = turned.col(axis);
      const auto reach = [&along](const std::array<Eigen::Vector2d, 4>& corners) {
        const auto [low, high] = std::minmax({corners[0].dot(along), corners[1].dot(along),
                                              corners[2].dot(along), corners[3].dot(along)});
        return std::array{low, high};
      };
      const auto [low, high] = reach(own);
      const auto [other_low, other_high] = reach(others);
      const double up = other_high - low;  // that way it would be out
      const double down = high - other_low;
      if (up <= 0.0 || down <= 0.0) return std::nullopt;
      const double depth = std::min(up, down);
      if (depth < least.depth_m) least = {up < down ? along : Eigen::Vector2d(-along), depth, {}};
    }
  }
  // Where corners of either are inside the other; of two that cross without, between them.
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int inside = 0;
  const auto add = [&](const std::array<Eigen::Vector2d, 4>& corners, const StandInRobot& in,
                       const Eigen::Vector2d& middle) {
    for (const Eigen::Vector2d& corner : corners) {
      if (!in.outline().contains(Eigen::Vector2d(in.heading().transpose() * (corner - middle)))) {
        continue;
      }
      sum += corner;
      ++inside;
    }
  };
  add(own, other, other.middle() + copy);
  add(others, robot, robot.middle());
  least.place = inside > 0 ? Eigen::Vector2d(sum / inside)
                           : Eigen::Vector2d(0.5 * (robot.middle() + other.middle() + copy));
  return least;
}

}  // namespace

StandInPlant::StandInPlant(const HeightField& terrain, const Assembly& model,
                           const PlantOptions& options, const BeltFit& fit)
    : ground_(ground_of(terrain, track_geometry(model), options, fit)) {
  const StandInKind kind = kind_of(model, options);
  for (const StartPose& start : options.starts) {
    robots_.push_back(
        std::make_unique<StandInRobot>(ground_, robots_.size(), kind, *options.soil, fit, start));
    check_apart(start);
  }
}

void StandInPlant::check_apart(const StartPose& start) const {
  const StandInRobot& last = *robots_.back();
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : last.corners()) box.extend(corner);
  check_between_walls(bounds_of(ground_.surface()), box, {start.x_m, start.y_m});
  for (std::size_t i = 0; i + 1 < robots_.size(); ++i) {
    if (!overlap(last, *robots_[i], terrain()).has_value()) continue;
    throw InputError("robots " + std::to_string(i) + " and " + std::to_string(robots_.size() - 1) +
                     " stand in one another at the start");
  }
}

void StandInPlant::push_from_walls(StandInRobot& robot) const {
  const BedBounds bed = bounds_of(ground_.surface());
  for (const Eigen::Vector2d& corner : robot.corners()) {
    const Eigen::Vector2d back = out_of_walls(bed, Eigen::AlignedBox2d(corner));
    for (const int axis : {0, 1}) {
      if (back[axis] == 0.0) continue;
      const Eigen::Vector2d normal = std::copysign(1.0, back[axis]) * Eigen::Vector2d::Unit(axis);
      robot.push(corner,
                 pushing(std::abs(back[axis]), robot.velocity_at(corner).dot(normal)) * normal);
    }
  }
}

void StandInPlant::push_apart(StandInRobot& robot, StandInRobot& other) const {
  const std::optional<Overlap> in = overlap(robot, other, terrain());
  if (!in.has_value()) return;
  const Eigen::Vector2d beside_other =
      in->place + (other.middle() - robot.middle()) - nearest_way(robot, other, terrain());
  const double parting =
      (robot.velocity_at(in->place) - other.velocity_at(beside_other)).dot(in->normal);
  const Eigen::Vector2d force = pushing(in->depth_m, parting) * in->normal;
  robot.push(in->place, force);
  other.push(beside_other, -force);
}

void StandInPlant::step(std::span<const DutyRatio> duty_ratios) {
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    robots_[i]->step_motors(duty_ratios[i], kTick_s / kStepsPerTick);
  }
  if (++steps_ % kStepsPerTick == 0) end_frame();
}

void StandInPlant::step_frame(const std::array<double, 2>& belts_m_per_s) {
  robots_[0]->run_belts(belts_m_per_s);
  steps_ += kStepsPerTick;
  end_frame();
}

void StandInPlant::follow_frame(const std::array<double, 2>& belts_m_per_s, const PlanarPose& pose,
                                const FrameMotion& motion) {
  robots_[0]->run_belts(belts_m_per_s);
  steps_ += kStepsPerTick;
  robots_[0]->follow(pose, motion);
  end_stride();
}

void StandInPlant::end_frame() {
  for (const auto& robot : robots_) {
    push_from_walls(*robot);
  }
  for (std::size_t i = 0; i < robots_.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) push_apart(*robots_[i], *robots_[k]);
  }
  for (const auto& robot : robots_) robot->move();
  end_stride();
}

/// The ground's part of a frame.
void StandInPlant::end_stride() {
  if (++stride_frames_ == kBeltStrideFrames) {
    stride_frames_ = 0;
    for (const auto& robot : robots_) robot->press();
    ground_.end_stride();
  }
  for (const auto& robot : robots_) robot->end_frame();
}

}  // namespace screed
