// A frame's columns out of the world and the firmware.
#include "host_sim/run/world/frame_recorder.h"

#include <cmath>
#include <numbers>

#include "host_sim/core/rotation.h"
#include "host_sim/physics/terrain/footprint_contact.h"

namespace screed {
namespace {

constexpr double kRadPerAngle = std::numbers::pi / 32768.0;

double wrap_rad(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

}  // namespace

SimFrame FrameRecorder::record(double time_s, const RobotView& plant, const Robot& robot) {
  const VehicleState& vehicle = plant.vehicle();
  const ChassisState chassis = vehicle.chassis();
  const Eigen::Matrix3d& rotation = chassis.pose.linear();
  const Eigen::Vector3d position = chassis.pose.translation();
  const Attitude attitude = attitude_of(rotation);
  const Eigen::Vector3d velocity = rotation.transpose() * chassis.velocity;

  SimFrame frame;
  frame.time = time_s;
  frame.x = position.x();
  frame.y = position.y();
  frame.z = position.z();
  // As travelled: a teleport is no motion.
  const Eigen::Vector3d travelled = plant.unwrapped_position();
  if (!first_) {
    frame.delta_x = travelled.x() - last_travelled_.x();
    frame.delta_y = travelled.y() - last_travelled_.y();
    frame.delta_theta = wrap_rad(attitude.heading - last_heading_);
    distance_m_ += (travelled - last_travelled_).norm();
  }
  first_ = false;
  last_travelled_ = travelled;
  last_heading_ = attitude.heading;

  const TrackSpeeds& targets = robot.drive().targets();
  frame.v_left = targets.left * 1e-3 / vehicle.wheel_radius_m(kLeft);
  frame.v_right = targets.right * 1e-3 / vehicle.wheel_radius_m(kRight);
  frame.pitch = attitude.pitch;
  frame.roll = attitude.roll;
  frame.yaw = attitude.heading;
  frame.linear = robot.motion().speed_mm_per_s * 1e-3;
  frame.angular = robot.motion().yaw_rate * kRadPerAngle;
  frame.velocity_x = velocity.x();
  frame.velocity_y = velocity.y();
  frame.velocity_z = velocity.z();
  frame.rate_x = chassis.omega_body.x();
  frame.rate_y = chassis.omega_body.y();
  frame.rate_z = chassis.omega_body.z();
  frame.track_left = vehicle.track_speed_m_per_s(kLeft);
  frame.track_right = vehicle.track_speed_m_per_s(kRight);
  frame.slip_left = signed_slip(frame.track_left, vehicle.ground_speed_m_per_s(kLeft));
  frame.slip_right = signed_slip(frame.track_right, vehicle.ground_speed_m_per_s(kRight));
  frame.sinkage_left = vehicle.sinkage_m(kLeft);
  frame.sinkage_right = vehicle.sinkage_m(kRight);
  frame.load_left = vehicle.load_n(kLeft);
  frame.load_right = vehicle.load_n(kRight);
  frame.current_left = vehicle.current_a(kLeft);
  frame.current_right = vehicle.current_a(kRight);
  frame.battery = plant.battery().terminal_v;
  frame.energy = plant.battery().energy_j;
  frame.est_pitch = robot.attitude().pitch() * kRadPerAngle;
  frame.est_roll = robot.attitude().roll() * kRadPerAngle;
  frame.est_heading = robot.attitude().heading() * kRadPerAngle;
  frame.odometry_x = robot.position().mm(kX) * 1e-3;
  frame.odometry_y = robot.position().mm(kY) * 1e-3;
  frame.state = static_cast<int32_t>(robot.supervisor().state());
  frame.leveling_state = static_cast<int32_t>(robot.leveling().state());
  frame.faults = robot.supervisor().faults();
  frame.beds_x = static_cast<int32_t>(plant.wrap_counts()[0]);
  frame.beds_y = static_cast<int32_t>(plant.wrap_counts()[1]);
  return frame;
}

}  // namespace screed
