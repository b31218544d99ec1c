#include "nn/surrogate/surrogate_plant.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/gravity.h"
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
// Of wheels and track, and what of the robot's mass a track feels when it speeds up.
constexpr double kTurnedInertia_kg_m2 = 1.8e-4;
// A track bridges the four support points: share of the displacement to the new pose that the
// body makes in a frame.
constexpr double kPoseSmoothing = 0.3;

Surrogate for_one(const Model& network) {
  return {network, SupportGeometry{}, 1};
}

int64_t beds_off(double coordinate, double size) {
  return static_cast<int64_t>(std::floor(coordinate / size + 0.5));
}

}  // namespace

SurrogatePlant::SurrogatePlant(HeightField terrain, const Assembly& model,
                               const PlantOptions& options, const Model& network)
    : SurrogatePlant(std::move(terrain), model, options, for_one(network)) {}

SurrogatePlant::SurrogatePlant(HeightField terrain, const Assembly& model,
                               const PlantOptions& options, Surrogate robot)
    : ground_(std::move(terrain)),
      geometry_(robot.geometry()),
      imu_position_(Eigen::Vector3d::Zero()),
      robot_(std::move(robot)),
      shafts_{DriveShaft(options.vehicle.motor, 1, kTurnedInertia_kg_m2),
              DriveShaft(options.vehicle.motor, 1, kTurnedInertia_kg_m2)},
      battery_(options.battery),
      vehicle_(*this) {
  if (!options.further_starts.empty()) {
    throw InputError("[robots] count = " + std::to_string(1 + options.further_starts.size()) +
                     ": networks move 1; several robots run without --model");
  }
  const VehicleParts bodies(model, options.vehicle);
  const HeightField level = HeightField::flat(1.0, 0.5);
  standing_height_m_ = bodies.resting_height(level, 0.0, 0.0, Eigen::Matrix3d::Identity());
  tread_m_ = bodies.tread_m();
  mass_kg_ = bodies.mass_kg();
  body_outline_ = bodies.outline_at_rest();
  geometry_.wheel_radius_m = bodies.wheel_radius_m(kLeft);
  const int imu = model.body_index("Imu");
  if (imu >= 0) imu_position_ = model.bodies[static_cast<size_t>(imu)].pose.translation();

  DrivingState start;
  start.pose = {options.start.x_m, options.start.y_m, options.start.attitude.heading};
  start.battery = options.battery;
  set_state(start);
  check_between_walls(bounds_of(ground_), outline(), {options.start.x_m, options.start.y_m});
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
  stride.v_left = shafts_[0].omega_rad_per_s();
  stride.v_right = shafts_[1].omega_rad_per_s();
  stride.pitch = now_.attitude.pitch;
  stride.roll = now_.attitude.roll;
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
  for (const Side side : {kLeft, kRight}) {
    const auto i = static_cast<size_t>(side);
    shafts_[i].spin(state.track_speed_m_per_s[i] / geometry_.wheel_radius_m);
    angle_offset_rad_[i] = state.shaft_angle_rad[i] - shafts_[i].angle_rad();
  }
  battery_ = state.battery;
  begin_stride(state.pose);
  find_support();
  turn_to({support_.roll, support_.pitch, state.pose.heading_rad});
  now_.place = {state.pose.x_m, state.pose.y_m, support_.height_m + standing_height_m_};
  before_ = now_;
  const auto [s, c] = portable::sine_cosine(state.pose.heading_rad);
  velocity_ << (state.last.forward_m * c - state.last.sideways_m * s) / kTick_s,
      (state.last.forward_m * s + state.last.sideways_m * c) / kTick_s, 0.0;
  imu_velocity_ = velocity_;
  imu_velocity_before_ = velocity_;
  rate_body_ << 0.0, 0.0, state.last.turn_rad / kTick_s;
  wrap_counts_ = {0, 0};
  if (ground_.wrap()) {
    wrap_counts_ = {beds_off(now_.place.x(), ground_.x_max() - ground_.x_min()),
                    beds_off(now_.place.y(), ground_.y_max() - ground_.y_min())};
  }
}

std::array<double, 2> SurrogatePlant::resistance() const {
  const double weight = 0.5 * mass_kg_ * kGravity_m_per_s2;
  const double left = vehicle_.track_speed_m_per_s(kLeft);
  const double right = vehicle_.track_speed_m_per_s(kRight);
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

void SurrogatePlant::step(const std::array<double, 2>& duty_ratio) {
  constexpr double kStep_s = kTick_s / kStepsPerTick;
  double current = 0.0;
  for (const Side side : {kLeft, kRight}) {
    const auto i = static_cast<size_t>(side);
    current += std::max(0.0, duty_ratio[i] * shafts_[i].current_a());
  }
  const std::array<double, 2> against = resistance();
  for (size_t i = 0; i < shafts_.size(); ++i) {
    // On a slope a braked track stands: what the ground takes is friction as well.
    shafts_[i].step(duty_ratio[i] * battery_.terminal_v, on_side_ ? 0.0 : -against[i], kStep_s);
  }
  battery_.step(current, kStep_s);
  ++steps_;
  if (steps_ % kStepsPerTick == 0) end_frame();
}

void SurrogatePlant::find_support() {
  const PlanarPose pose = robot_.pose(0);
  const auto [s, c] = portable::sine_cosine(pose.heading_rad);
  support_ = support_at(ground_, geometry_, pose.x_m, pose.y_m, c, s);
}

void SurrogatePlant::turn_to(const Attitude& attitude) {
  now_.attitude = attitude;
  now_.rotation = rotation_from(attitude);
  sin_pitch_ = portable::sin(attitude.pitch);
}

void SurrogatePlant::set_at_rest() {
  before_ = now_;
  velocity_.setZero();
  imu_velocity_before_.setZero();
  imu_velocity_.setZero();
  rate_body_.setZero();
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
  if (on_side_) {
    set_at_rest();
    return;
  }
  const double left = vehicle_.track_speed_m_per_s(kLeft);
  const double right = vehicle_.track_speed_m_per_s(kRight);
  robot_.step_on_slope(support_.pitch, support_.roll, {&left, 1}, {&right, 1});
  stop_at_walls();
  if (ground_change_) {
    stride_tracks_m_[kLeft] += left * kTick_s;
    stride_tracks_m_[kRight] += right * kTick_s;
    if (++stride_frames_ == kStrideFrames) end_stride();
  }

  before_ = now_;
  find_support();
  const PlanarPose pose = robot_.pose(0);
  const auto part = [](double from, double to) { return from + kPoseSmoothing * (to - from); };
  turn_to({part(before_.attitude.roll, support_.roll), part(before_.attitude.pitch, support_.pitch),
           pose.heading_rad});
  now_.place = {pose.x_m, pose.y_m,
                part(before_.place.z(), support_.height_m + standing_height_m_)};

  const Eigen::Matrix3d& from = before_.rotation;
  const Eigen::Matrix3d& to = now_.rotation;
  rate_body_ = rotation_vector(Eigen::Quaterniond(from.transpose() * to)) / kTick_s;
  velocity_ = (now_.place - before_.place) / kTick_s;
  imu_velocity_before_ = imu_velocity_;
  imu_velocity_ = velocity_ + (to - from) * imu_position_ / kTick_s;
  if (ground_.wrap()) {
    wrap_counts_ = {beds_off(now_.place.x(), ground_.x_max() - ground_.x_min()),
                    beds_off(now_.place.y(), ground_.y_max() - ground_.y_min())};
  }
}

double SurrogatePlant::time_s() const {
  return static_cast<double>(steps_) / (kStepsPerTick * static_cast<double>(kTickRate_hz));
}

ImuTruth SurrogatePlant::motion() const {
  ImuTruth truth;
  truth.body_to_world = now_.rotation;
  truth.mean_rate_rad_per_s = rate_body_;
  truth.mean_specific_force =
      truth.body_to_world.transpose() * ((imu_velocity_ - imu_velocity_before_) / kTick_s +
                                         kGravity_m_per_s2 * Eigen::Vector3d::UnitZ());
  truth.altitude_m = now_.place.z();
  return truth;
}

void SurrogatePlant::lay_on_side() {
  on_side_ = true;
  turn_to({-std::numbers::pi / 2.0, 0.0, now_.attitude.heading});
  set_at_rest();
}

Eigen::Vector3d SurrogatePlant::unwrapped_position() const {
  return now_.place;
}

ChassisState SurrogatePlant::Body::chassis() const {
  ChassisState state;
  state.pose.linear() = plant_.now_.rotation;
  state.pose.translation() = plant_.now_.place;
  const HeightField& ground = plant_.ground_;
  if (ground.wrap()) {
    state.pose.translation().x() -=
        static_cast<double>(plant_.wrap_counts_[0]) * (ground.x_max() - ground.x_min());
    state.pose.translation().y() -=
        static_cast<double>(plant_.wrap_counts_[1]) * (ground.y_max() - ground.y_min());
  }
  state.velocity = plant_.velocity_;
  state.omega_body = plant_.rate_body_;
  return state;
}

double SurrogatePlant::Body::track_speed_m_per_s(Side side) const {
  return plant_.shafts_[static_cast<size_t>(side)].omega_rad_per_s() *
         plant_.geometry_.wheel_radius_m;
}
double SurrogatePlant::Body::shaft_angle_rad(Side side) const {
  const auto i = static_cast<size_t>(side);
  return plant_.shafts_[i].angle_rad() + plant_.angle_offset_rad_[i];
}
double SurrogatePlant::Body::current_a(Side side) const {
  return plant_.shafts_[static_cast<size_t>(side)].current_a();
}
double SurrogatePlant::Body::wheel_radius_m(Side /*side*/) const {
  return plant_.geometry_.wheel_radius_m;
}
double SurrogatePlant::Body::load_n(Side /*side*/) const {
  return plant_.on_side_ ? 0.0 : 0.5 * plant_.mass_kg_ * kGravity_m_per_s2;
}
double SurrogatePlant::Body::ground_speed_m_per_s(Side side) const {
  const double arm = (side == kLeft ? 0.5 : -0.5) * plant_.tread_m_;
  return plant_.now_.rotation.col(0).dot(plant_.velocity_) - plant_.rate_body_.z() * arm;
}

}  // namespace screed::nn
