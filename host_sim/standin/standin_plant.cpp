#include "host_sim/standin/standin_plant.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/physics/vehicle/vehicle_parts.h"
#include "host_sim/physics/world/wall_clearance.h"

namespace screed {

namespace {
// Strides are five frames apart: share of the way to the belts' new plane that the body makes in
// one.
constexpr double kFollowing = 0.3;

}  // namespace

StandInRobot::StandInRobot(BeltGround& ground, std::size_t number, const StandInKind& kind,
                           const SoilParameters& soil, const BeltFit& fit, const StartPose& start)
    : PlanarRobot(ground.surface(), kind.planar),
      ground_(ground),
      number_(number),
      kind_(kind),
      belts_(kind.tracks, soil, fit),
      pose_{start.x_m, start.y_m, start.attitude.heading},
      stride_(pose_) {
  ground_.place(number_, pose_);
  plane_ = ground_.plane(number_);
  DrivingState start_state;
  start_state.pose = pose_;
  start_state.battery = kind.planar.battery;
  begin_at(start_state, body_pose());
}

void StandInRobot::set_state(const DrivingState& state) {
  pose_ = state.pose;
  motion_ = state.last;
  belts_.set_motion(motion_, ground_.support(number_));
  stride_ = BeltStrideRecorder(pose_);
  begin_at(state, body_pose());
}

void StandInRobot::step_motors(const DutyRatio& duty, double dt) {
  std::array<double, 2> torque_nm{};
  for (std::size_t i = 0; i < torque_nm.size(); ++i) {
    const double traction = on_side() ? 0.0 : belts_.traction_n()[i];
    torque_nm[i] = -traction * kind_.tracks.radius_m;
  }
  step_shafts(duty, torque_nm, dt);
}

void StandInRobot::move() {
  if (on_side()) return;
  motion_ = belts_.step(track_speed_m_per_s(kLeft), track_speed_m_per_s(kRight),
                        ground_.support(number_), push_);
  push_.setZero();
  pose_.move(motion_);
  stride_.add_frame(motion_, belts_.shear());
}

void StandInRobot::follow(const PlanarPose& pose, const FrameMotion& motion) {
  motion_ = motion;
  belts_.follow(track_speed_m_per_s(kLeft), track_speed_m_per_s(kRight), ground_.support(number_),
                motion);
  pose_ = pose;
  stride_.add_frame(motion_, belts_.shear());
}

void StandInRobot::press() {
  if (!on_side()) ground_.press(number_, stride_.take(pose_));
}

void StandInRobot::end_frame() {
  if (on_side()) {
    stand_still();
    return;
  }
  const TrackPlane& to = ground_.plane(number_);
  const auto part = [](double from, double towards) {
    return from + kFollowing * (towards - from);
  };
  const double carried = plane_.forward * motion_.forward_m + plane_.left * motion_.sideways_m;
  plane_ = {part(plane_.height_m + carried, to.height_m), part(plane_.forward, to.forward),
            part(plane_.left, to.left)};
  move_body(body_pose());
}

void StandInRobot::push(const Eigen::Vector2d& at, const Eigen::Vector2d& force) {
  const Eigen::Vector2d arm = at - middle();
  const Eigen::Vector2d own = heading().transpose() * force;
  push_ += Eigen::Vector3d(own.x(), own.y(), arm.x() * force.y() - arm.y() * force.x());
}

std::array<Eigen::Vector2d, 4> StandInRobot::corners() const {
  const Eigen::Matrix2d turned = heading();
  const auto corner = [&](Eigen::AlignedBox2d::CornerType which) {
    return Eigen::Vector2d(turned * kind_.outline.corner(which) + middle());
  };
  return {corner(Eigen::AlignedBox2d::BottomLeft), corner(Eigen::AlignedBox2d::BottomRight),
          corner(Eigen::AlignedBox2d::TopRight), corner(Eigen::AlignedBox2d::TopLeft)};
}

Eigen::Vector2d StandInRobot::velocity_at(const Eigen::Vector2d& place) const {
  const Eigen::Vector2d arm = place - middle();
  return velocity().head<2>() + motion_.turn_rad / kTick_s * Eigen::Vector2d(-arm.y(), arm.x());
}

StandInRobot::BodyPose StandInRobot::body_pose() const {
  const double pitch = portable::atan(plane_.forward);
  const double cos_pitch = portable::cos(pitch);
  const double roll = portable::atan(plane_.left * cos_pitch);
  const Attitude attitude{roll, pitch, pose_.heading_rad};
  return {attitude,
          {pose_.x_m, pose_.y_m,
           plane_.height_m + kind_.tracks.below_m * cos_pitch * portable::cos(roll)},
          rotation_from(attitude)};
}

double StandInRobot::load_n(Side side) const {
  if (on_side()) return 0.0;
  double share = 0.0;
  for (const double load : ground_.support(number_).load[static_cast<std::size_t>(side)]) {
    share += load;
  }
  return share * kind_.tracks.mass_kg * kGravity_m_per_s2;
}

double StandInRobot::sinkage_m(Side side) const {
  return ground_.sinkage_m(number_, static_cast<std::size_t>(side));
}

// Clock, walls and contact between robots.
//
// Walls push the corners of a robot's outline out, another robot its outline, by a spring and a
// damper that never pull and without friction.

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
  kind.tracks = track_geometry(model, options.vehicle);
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
    : ground_(ground_of(terrain, track_geometry(model, options.vehicle), options, fit)) {
  const StandInKind kind = kind_of(model, options);
  for (const StartPose& start : options.starts) {
    robots_.push_back(
        std::make_unique<StandInRobot>(ground_, robots_.size(), kind, *options.soil, fit, start));
    check_apart(start, options.starts.size());
  }
}

void StandInPlant::check_apart(const StartPose& start, size_t starts) const {
  const StandInRobot& last = *robots_.back();
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& corner : last.corners()) box.extend(corner);
  check_between_walls(bounds_of(ground_.surface()), box, {start.x_m, start.y_m}, robots_.size() - 1,
                      starts);
  for (std::size_t i = 0; i + 1 < robots_.size(); ++i) {
    if (!overlap(last, *robots_[i], terrain()).has_value()) continue;
    refuse_overlap(i, robots_.size() - 1, starts);
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
