#include "nn/surrogate/surrogate_plant.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/rotation.h"
#include "host_sim/physics/vehicle/vehicle_parts.h"
#include "host_sim/physics/world/wall_clearance.h"

namespace screed::nn {
namespace {
// Fitted to motor currents on four soils (docs/networks.md): what the ground takes from a track, as
// shares of the weight it carries, while driving and while the robot is turned on the spot.
constexpr double kRollingShare = 0.03;
constexpr double kTurningShare = 0.11;
constexpr double kRollingSpeed_m_per_s = 0.01;  // at which they are felt in full
constexpr double kTurningRate_rad_per_s = 0.3;
// A track bridges the four support points: share of the displacement to the new pose that the
// body makes in a frame.
constexpr double kPoseSmoothing = 0.3;

Surrogate for_one(const Model& network) {
  return {network, SupportGeometry{}, 1};
}

PlanarRobot::Kind kind_of(const Assembly& model, const PlantOptions& options) {
  const VehicleParts bodies(model, options.vehicle);
  PlanarRobot::Kind kind;
  kind.motor = options.vehicle.motor;
  kind.battery = options.battery;
  kind.wheel_radius_m = bodies.wheel_radius_m(kLeft);
  kind.half_tread_m = 0.5 * bodies.tread_m();
  const int imu = model.body_index("Imu");
  if (imu >= 0) kind.imu = model.bodies[static_cast<size_t>(imu)].pose.translation();
  return kind;
}

}  // namespace

SurrogatePlant::SurrogatePlant(HeightField terrain, const Assembly& model,
                               const PlantOptions& options, const Model& network)
    : SurrogatePlant(std::move(terrain), model, options, for_one(network)) {}

SurrogatePlant::SurrogatePlant(HeightField terrain, const Assembly& model,
                               const PlantOptions& options, Surrogate robot)
    : PlanarRobot(ground_, kind_of(model, options)),
      ground_(std::move(terrain)),
      geometry_(robot.geometry()),
      robot_(std::move(robot)) {
  if (options.starts.size() != 1) {
    throw InputError("[robots] count = " + std::to_string(options.starts.size()) +
                     ": networks move 1; several robots run without --model");
  }
  const VehicleParts bodies(model, options.vehicle);
  const HeightField level = HeightField::flat(1.0, 0.5);
  standing_height_m_ = bodies.resting_height(level, 0.0, 0.0, Eigen::Matrix3d::Identity());
  tread_m_ = bodies.tread_m();
  mass_kg_ = bodies.mass_kg();
  body_outline_ = bodies.outline_at_rest();
  geometry_.wheel_radius_m = wheel_radius_m(kLeft);

  DrivingState start;
  const StartPose& place = options.starts[0];
  start.pose = {place.x_m, place.y_m, place.attitude.heading};
  start.battery = options.battery;
  set_state(start);
  check_between_walls(bounds_of(ground_), outline(), {place.x_m, place.y_m}, 0, 1);
}

/// Its displacements in the robot's axes at its end. What stands still changes nothing.
void SurrogatePlant::end_stride() {
  constexpr double kStill = 1e-6;  // m, rad
  const PlanarPose pose = robot_.pose(0);
  const auto [s, c] = portable::sine_cosine(pose.heading_rad);
  const double dx = pose.x_m - stride_begin_.x_m;
  const double dy = pose.y_m - stride_begin_.y_m;
  Stride stride;
  stride.x_m = pose.x_m;
  stride.y_m = pose.y_m;
  stride.yaw_rad = pose.heading_rad;
  stride.forward_m = c * dx + s * dy;
  stride.sideways_m = c * dy - s * dx;
  stride.turn_rad = pose.heading_rad - stride_begin_.heading_rad;
  stride.track_m = stride_tracks_m_;
  stride.v_left = wheel_rate_rad_per_s(kLeft);
  stride.v_right = wheel_rate_rad_per_s(kRight);
  stride.pitch = body().attitude.pitch;
  stride.roll = body().attitude.roll;
  begin_stride(pose);
  const bool still = std::abs(stride.forward_m) + std::abs(stride.sideways_m) < kStill &&
                     std::abs(stride.turn_rad) < kStill &&
                     std::abs(stride.track_m[0]) + std::abs(stride.track_m[1]) < kStill;
  if (!still) ground_change_(ground_, stride);
}

void SurrogatePlant::begin_stride(const PlanarPose& pose) {
  stride_begin_ = pose;
  stride_tracks_m_ = {};
  stride_frames_ = 0;
}

void SurrogatePlant::set_state(const DrivingState& state) {
  robot_.set_pose(0, state.pose, state.last);
  begin_stride(state.pose);
  find_support();
  begin_at(state,
           pose_of_body(support_.roll, support_.pitch, support_.height_m + standing_height_m_));
}

/// There, and it heads as the network says.
SurrogatePlant::BodyPose SurrogatePlant::pose_of_body(double roll, double pitch, double height_m) {
  const PlanarPose pose = robot_.pose(0);
  const Attitude attitude{roll, pitch, pose.heading_rad};
  sin_pitch_ = portable::sin(pitch);
  return {attitude, {pose.x_m, pose.y_m, height_m}, rotation_from(attitude)};
}

std::array<double, 2> SurrogatePlant::resistance() const {
  const double weight = 0.5 * mass_kg_ * kGravity_m_per_s2;
  const double left = track_speed_m_per_s(kLeft);
  const double right = track_speed_m_per_s(kRight);
  const double turn = (right - left) / tread_m_;
  const double against_turn = kTurningShare * portable::tanh(turn / kTurningRate_rad_per_s);
  const auto torque = [&](double speed, double turning) {
    const double force =
        weight *
        (sin_pitch_ + kRollingShare * portable::tanh(speed / kRollingSpeed_m_per_s) + turning);
    return force * geometry_.wheel_radius_m;
  };
  return {torque(left, -against_turn), torque(right, against_turn)};
}

void SurrogatePlant::step(std::span<const DutyRatio> duty_ratios) {
  // On a slope a braked track stands: what the ground takes is friction as well.
  const std::array<double, 2> against = resistance();
  const std::array<double, 2> torque_nm =
      on_side() ? std::array{0.0, 0.0} : std::array{-against[0], -against[1]};
  step_shafts(duty_ratios[0], torque_nm, kTick_s / kStepsPerTick);
  ++steps_;
  if (steps_ % kStepsPerTick == 0) end_frame();
}

void SurrogatePlant::find_support() {
  const PlanarPose pose = robot_.pose(0);
  const auto [s, c] = portable::sine_cosine(pose.heading_rad);
  support_ = support_at(ground_, geometry_, pose.x_m, pose.y_m, c, s);
}

Eigen::AlignedBox2d SurrogatePlant::outline() const {
  const PlanarPose pose = robot_.pose(0);
  const Eigen::Matrix2d turned = rotation_by(pose.heading_rad);
  Eigen::AlignedBox2d box;
  for (const auto corner : {Eigen::AlignedBox2d::BottomLeft, Eigen::AlignedBox2d::BottomRight,
                            Eigen::AlignedBox2d::TopLeft, Eigen::AlignedBox2d::TopRight}) {
    box.extend(Eigen::Vector2d(turned * body_outline_.corner(corner)));
  }
  return box.translate(Eigen::Vector2d(pose.x_m, pose.y_m));
}

void SurrogatePlant::stop_at_walls() {
  const Eigen::Vector2d back = out_of_walls(bounds_of(ground_), outline());
  if (!back.isZero(0.0)) robot_.displace(0, back.x(), back.y());
}

void SurrogatePlant::end_frame() {
  if (on_side()) {
    stand_still();
    return;
  }
  const double left = track_speed_m_per_s(kLeft);
  const double right = track_speed_m_per_s(kRight);
  robot_.step_on_slope(support_.pitch, support_.roll, {&left, 1}, {&right, 1});
  stop_at_walls();
  if (ground_change_) {
    stride_tracks_m_[kLeft] += left * kTick_s;
    stride_tracks_m_[kRight] += right * kTick_s;
    if (++stride_frames_ == kStrideFrames) end_stride();
  }

  const BodyPose before = body();
  find_support();
  const auto part = [](double from, double to) { return from + kPoseSmoothing * (to - from); };
  move_body(pose_of_body(part(before.attitude.roll, support_.roll),
                         part(before.attitude.pitch, support_.pitch),
                         part(before.place.z(), support_.height_m + standing_height_m_)));
}

double SurrogatePlant::load_n(Side /*side*/) const {
  return on_side() ? 0.0 : 0.5 * mass_kg_ * kGravity_m_per_s2;
}
}  // namespace screed::nn
