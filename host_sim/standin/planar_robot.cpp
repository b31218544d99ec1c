#include "host_sim/standin/planar_robot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/rotation.h"

namespace screed {
namespace {
// Of wheels and track, and what of the robot's mass a track feels when it speeds up.
constexpr double kTurnedInertia_kg_m2 = 1.8e-4;

int64_t beds_off(double coordinate, double size) {
  return static_cast<int64_t>(std::floor(coordinate / size + 0.5));
}

}  // namespace

PlanarRobot::PlanarRobot(const HeightField& ground, const Kind& kind)
    : ground_(ground),
      kind_(kind),
      shafts_{DriveShaft(kind.motor, 1, kTurnedInertia_kg_m2),
              DriveShaft(kind.motor, 1, kTurnedInertia_kg_m2)},
      battery_(kind.battery) {}

void PlanarRobot::spin_tracks(const std::array<double, 2>& m_per_s) {
  for (std::size_t i = 0; i < shafts_.size(); ++i)
    shafts_[i].spin(m_per_s[i] / kind_.wheel_radius_m);
}

void PlanarRobot::step_shafts(const DutyRatio& duty, const std::array<double, 2>& torque_nm,
                              double dt) {
  double current = 0.0;
  for (std::size_t i = 0; i < shafts_.size(); ++i) {
    current += std::max(0.0, duty[i] * shafts_[i].current_a());
    shafts_[i].step(duty[i] * battery_.terminal_v, torque_nm[i], dt);
  }
  battery_.step(current, dt);
}

void PlanarRobot::begin_at(const DrivingState& state, const BodyPose& body) {
  spin_tracks(state.track_speed_m_per_s);
  for (std::size_t i = 0; i < shafts_.size(); ++i) {
    angle_offset_rad_[i] = state.shaft_angle_rad[i] - shafts_[i].angle_rad();
  }
  battery_ = state.battery;
  now_ = body;
  velocity_ << rotation_by(state.pose.heading_rad) *
                   Eigen::Vector2d(state.last.forward_m, state.last.sideways_m) / kTick_s,
      0.0;
  imu_velocity_ = imu_velocity_before_ = velocity_;
  rate_body_ << 0.0, 0.0, state.last.turn_rad / kTick_s;
  count_wraps();
}

// Nothing here falls or bounces: a body that is far from the ground, or fast, is one that the
// ground's closed form or the network has lost.
void PlanarRobot::check(const BodyPose& body) const {
  constexpr double kFastest_m_per_s = 10.0;
  const double reach = 3.0 * (kind_.half_tread_m + kind_.wheel_radius_m);
  const Eigen::Vector3d& at = body.place;
  const double above = at.z() - ground_.at(at.x(), at.y()).height;
  const double speed = (at - now_.place).norm() / kTick_s;
  if (std::abs(above) < reach && speed < kFastest_m_per_s) return;
  char line[200];
  std::snprintf(line, sizeof line,
                "the surrogate world diverged: the robot's origin %.3g m above the ground, at "
                "%.3g m/s; the ground may be too soft or too steep for a world without dynamics",
                above, speed);
  throw RunError(line);
}

void PlanarRobot::move_body(const BodyPose& body) {
  check(body);
  const BodyPose before = now_;
  now_ = body;
  const Eigen::Matrix3d& from = before.rotation;
  const Eigen::Matrix3d& to = now_.rotation;
  rate_body_ = rotation_vector(Eigen::Quaterniond(from.transpose() * to)) / kTick_s;
  velocity_ = (now_.place - before.place) / kTick_s;
  imu_velocity_before_ = imu_velocity_;
  imu_velocity_ = velocity_ + (to - from) * kind_.imu / kTick_s;
  count_wraps();
}

void PlanarRobot::stand_still() {
  velocity_.setZero();
  imu_velocity_before_.setZero();
  imu_velocity_.setZero();
  rate_body_.setZero();
}

void PlanarRobot::count_wraps() {
  if (!ground_.wrap()) return;
  wrap_counts_ = {beds_off(now_.place.x(), ground_.x_max() - ground_.x_min()),
                  beds_off(now_.place.y(), ground_.y_max() - ground_.y_min())};
}

ImuTruth PlanarRobot::motion() const {
  ImuTruth truth;
  truth.body_to_world = now_.rotation;
  truth.mean_rate_rad_per_s = rate_body_;
  truth.mean_specific_force =
      truth.body_to_world.transpose() * ((imu_velocity_ - imu_velocity_before_) / kTick_s +
                                         kGravity_m_per_s2 * Eigen::Vector3d::UnitZ());
  truth.altitude_m = now_.place.z();
  return truth;
}

void PlanarRobot::lay_on_side() {
  on_side_ = true;
  now_.attitude.roll = -std::numbers::pi / 2.0;
  now_.attitude.pitch = 0.0;
  now_.rotation = rotation_from(now_.attitude);
  stand_still();
}

ChassisState PlanarRobot::chassis() const {
  ChassisState state;
  state.pose.linear() = now_.rotation;
  state.pose.translation() = now_.place;
  if (ground_.wrap()) {
    state.pose.translation().x() -=
        static_cast<double>(wrap_counts_[0]) * (ground_.x_max() - ground_.x_min());
    state.pose.translation().y() -=
        static_cast<double>(wrap_counts_[1]) * (ground_.y_max() - ground_.y_min());
  }
  state.velocity = velocity_;
  state.omega_body = rate_body_;
  return state;
}

double PlanarRobot::track_speed_m_per_s(Side side) const {
  return wheel_rate_rad_per_s(side) * kind_.wheel_radius_m;
}

double PlanarRobot::shaft_angle_rad(Side side) const {
  const auto i = static_cast<std::size_t>(side);
  return shafts_[i].angle_rad() + angle_offset_rad_[i];
}

double PlanarRobot::current_a(Side side) const {
  return shafts_[static_cast<std::size_t>(side)].current_a();
}

double PlanarRobot::ground_speed_m_per_s(Side side) const {
  const double arm = side == kLeft ? kind_.half_tread_m : -kind_.half_tread_m;
  return now_.rotation.col(0).dot(velocity_) - rate_body_.z() * arm;
}

}  // namespace screed
