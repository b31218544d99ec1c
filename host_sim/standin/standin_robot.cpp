#include "host_sim/standin/standin_robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/gravity.h"

namespace screed {
namespace {
// Of wheels and belt, and what of the robot's mass a belt feels when it speeds up.
constexpr double kTurnedInertia_kg_m2 = 1.8e-4;
// Strides are five frames apart: share of the way to the belts' new plane that the body makes in
// one.
constexpr double kFollowing = 0.3;

int64_t beds_off(double coordinate, double size) {
  return static_cast<int64_t>(std::floor(coordinate / size + 0.5));
}

}  // namespace

StandInRobot::StandInRobot(const Environment& world, BeltGround& ground, std::size_t number,
                           const StandInKind& kind, const SoilParameters& soil, const BeltFit& fit,
                           const StartPose& start)
    : world_(world),
      ground_(ground),
      number_(number),
      kind_(kind),
      shafts_{DriveShaft(kind.motor, 1, kTurnedInertia_kg_m2),
              DriveShaft(kind.motor, 1, kTurnedInertia_kg_m2)},
      battery_(kind.battery),
      belts_(kind.tracks, soil, fit),
      pose_{start.x_m, start.y_m, start.attitude.heading},
      stride_(pose_) {
  ground_.place(number_, pose_);
  plane_ = ground_.plane(number_);
  now_ = body_pose();
  count_wraps();
}

void StandInRobot::run_belts(const std::array<double, 2>& belts_m_per_s) {
  for (std::size_t i = 0; i < shafts_.size(); ++i) {
    shafts_[i].spin(belts_m_per_s[i] / kind_.tracks.radius_m);
  }
}

void StandInRobot::set_state(const DrivingState& state) {
  run_belts(state.track_speed_m_per_s);
  for (std::size_t i = 0; i < shafts_.size(); ++i) {
    angle_offset_rad_[i] = state.shaft_angle_rad[i] - shafts_[i].angle_rad();
  }
  battery_ = state.battery;
  pose_ = state.pose;
  motion_ = state.last;
  belts_.set_motion(motion_, ground_.support(number_));
  stride_ = BeltStrideRecorder(pose_);
  now_ = body_pose();
  velocity_ << heading() * Eigen::Vector2d(motion_.forward_m, motion_.sideways_m) / kTick_s, 0.0;
  imu_velocity_ = imu_velocity_before_ = velocity_;
  rate_body_ << 0.0, 0.0, motion_.turn_rad / kTick_s;
  count_wraps();
}

void StandInRobot::step_motors(const DutyRatio& duty, double dt) {
  double current = 0.0;
  for (std::size_t i = 0; i < shafts_.size(); ++i) {
    current += std::max(0.0, duty[i] * shafts_[i].current_a());
    const double traction = on_side_ ? 0.0 : belts_.traction_n()[i];
    shafts_[i].step(duty[i] * battery_.terminal_v, -traction * kind_.tracks.radius_m, dt);
  }
  battery_.step(current, dt);
}

void StandInRobot::move() {
  if (on_side_) return;
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
  if (!on_side_) ground_.press(number_, stride_.take(pose_));
}

void StandInRobot::end_frame() {
  if (on_side_) {
    set_at_rest();
    return;
  }
  const TrackPlane& to = ground_.plane(number_);
  const auto part = [](double from, double towards) {
    return from + kFollowing * (towards - from);
  };
  const double carried = plane_.forward * motion_.forward_m + plane_.left * motion_.sideways_m;
  plane_ = {part(plane_.height_m + carried, to.height_m), part(plane_.forward, to.forward),
            part(plane_.left, to.left)};
  const BodyPose before = now_;
  now_ = body_pose();
  const Eigen::Matrix3d& from = before.rotation;
  const Eigen::Matrix3d& now = now_.rotation;
  rate_body_ = rotation_vector(Eigen::Quaterniond(from.transpose() * now)) / kTick_s;
  velocity_ = (now_.place - before.place) / kTick_s;
  imu_velocity_before_ = imu_velocity_;
  imu_velocity_ = velocity_ + (now - from) * kind_.imu / kTick_s;
  count_wraps();
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
  return velocity_.head<2>() + motion_.turn_rad / kTick_s * Eigen::Vector2d(-arm.y(), arm.x());
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

void StandInRobot::set_at_rest() {
  motion_ = {};
  velocity_.setZero();
  imu_velocity_before_.setZero();
  imu_velocity_.setZero();
  rate_body_.setZero();
}

void StandInRobot::count_wraps() {
  const HeightField& ground = ground_.surface();
  if (!ground.wrap()) return;
  wrap_counts_ = {beds_off(now_.place.x(), ground.x_max() - ground.x_min()),
                  beds_off(now_.place.y(), ground.y_max() - ground.y_min())};
}

ImuTruth StandInRobot::motion() const {
  ImuTruth truth;
  truth.body_to_world = now_.rotation;
  truth.mean_rate_rad_per_s = rate_body_;
  truth.mean_specific_force =
      truth.body_to_world.transpose() * ((imu_velocity_ - imu_velocity_before_) / kTick_s +
                                         kGravity_m_per_s2 * Eigen::Vector3d::UnitZ());
  truth.altitude_m = now_.place.z();
  return truth;
}

void StandInRobot::lay_on_side() {
  on_side_ = true;
  now_.attitude.roll = -std::numbers::pi / 2.0;
  now_.attitude.pitch = 0.0;
  now_.rotation = rotation_from(now_.attitude);
  set_at_rest();
}

ChassisState StandInRobot::chassis() const {
  ChassisState state;
  state.pose.linear() = now_.rotation;
  state.pose.translation() = now_.place;
  const HeightField& ground = ground_.surface();
  if (ground.wrap()) {
    state.pose.translation().x() -=
        static_cast<double>(wrap_counts_[0]) * (ground.x_max() - ground.x_min());
    state.pose.translation().y() -=
        static_cast<double>(wrap_counts_[1]) * (ground.y_max() - ground.y_min());
  }
  state.velocity = velocity_;
  state.omega_body = rate_body_;
  return state;
}

double StandInRobot::track_speed_m_per_s(Side side) const {
  return shafts_[static_cast<std::size_t>(side)].omega_rad_per_s() * kind_.tracks.radius_m;
}

double StandInRobot::shaft_angle_rad(Side side) const {
  const auto i = static_cast<std::size_t>(side);
  return shafts_[i].angle_rad() + angle_offset_rad_[i];
}

double StandInRobot::current_a(Side side) const {
  return shafts_[static_cast<std::size_t>(side)].current_a();
}

double StandInRobot::load_n(Side side) const {
  if (on_side_) return 0.0;
  double share = 0.0;
  for (const double load : ground_.support(number_).load[static_cast<std::size_t>(side)]) {
    share += load;
  }
  return share * kind_.tracks.mass_kg * kGravity_m_per_s2;
}

double StandInRobot::sinkage_m(Side side) const {
  return ground_.sinkage_m(number_, static_cast<std::size_t>(side));
}

double StandInRobot::ground_speed_m_per_s(Side side) const {
  const double arm = side == kLeft ? kind_.tracks.half_tread_m : -kind_.tracks.half_tread_m;
  return now_.rotation.col(0).dot(velocity_) - rate_body_.z() * arm;
}

}  // namespace screed
