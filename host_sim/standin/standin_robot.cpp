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

}  // namespace screed
