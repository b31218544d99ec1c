// One robot in one world of physics.
#include "host_sim/world/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

constexpr double kTick_s = 1.0 / kTickRate_hz;

int steps_in_tick(double physics_step_s) {
  const double steps = kTick_s / physics_step_s;
  const double whole = std::round(steps);
  if (!(whole >= 1.0) || std::abs(steps - whole) > 1e-6) {
    throw InputError("[physics] step = " + std::to_string(physics_step_s) +
                     " s; it must divide the control tick of 0.01 s into whole steps");
  }
  return static_cast<int>(whole);
}

Eigen::Vector3d imu_position(const Assembly& model) {
  const int imu = model.body_index("Imu");
  return imu < 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                 : Eigen::Vector3d(model.bodies[static_cast<size_t>(imu)].pose.translation());
}

}  // namespace

World::World(HeightField terrain, const Assembly& model, const BoardConstants& board,
             const WorldOptions& options, std::ostream* telemetry_log)
    : options_(options),
      board_(board),
      terrain_(std::move(terrain)),
      vehicle_(ode_, model, options.vehicle),
      battery_(options.battery),
      imu_(options.seed, options.imu),
      uplink_(options.seed, "uplink", options.radio),
      downlink_(options.seed, "downlink", options.radio),
      ground_(options.ground_station_arms, options.drive, telemetry_log),
      imu_position_(imu_position(model)),
      steps_per_tick_(steps_in_tick(options.physics_step_s)) {
  const StartPose& start = options.start;
  const Eigen::Matrix3d rotation = rotation_from(start.attitude);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation;
  const double resting = vehicle_.resting_height(terrain_, start.x_m, start.y_m, rotation);
  pose.translation() << start.x_m, start.y_m, start.z_m.value_or(resting);
  if (start.z_m.has_value() && *start.z_m < resting - 0.01) {
    throw InputError("[vehicle] z = " + std::to_string(*start.z_m) +
                     " m puts the robot into the ground; at this place it must be " +
                     std::to_string(resting) + " or more (leave z out to set the robot down)");
  }
  vehicle_.place(pose);
  if (!start.z_m.has_value()) settle();
}

void World::settle() {
  constexpr double kSettle_s = 1.5;
  const auto steps = static_cast<int>(std::lround(kSettle_s / options_.physics_step_s));
  for (int i = 0; i < steps; ++i) {
    vehicle_.apply_forces(terrain_, {0.0, 0.0}, options_.physics_step_s);
    ode_.step(options_.physics_step_s);
  }
  last_imu_velocity_ = imu_velocity(vehicle_.chassis());
}

Eigen::Vector3d World::imu_velocity(const ChassisState& chassis) const {
  const Eigen::Matrix3d& rotation = chassis.pose.linear();
  return chassis.velocity + rotation * chassis.omega_body.cross(imu_position_);
}

void World::step_physics() {
  const double dt = options_.physics_step_s;
  rate_sum_.setZero();
  for (int i = 0; i < steps_per_tick_; ++i) {
    std::array<double, 2> voltage{};
    double current = 0.0;
    for (const Side side : {kLeft, kRight}) {
      const double share = static_cast<double>(duty_[static_cast<size_t>(side)]) / kDutyMax;
      voltage[static_cast<size_t>(side)] = share * battery_.terminal_v;
      // The driver's off phase brakes: current then circulates in the motor, and never flows back
      // into the battery.
      current += std::max(0.0, share * vehicle_.current_a(side));
    }
    vehicle_.apply_forces(terrain_, voltage, dt);
    ode_.step(dt);
    battery_.step(current, dt);
    rate_sum_ += vehicle_.chassis().omega_body;
  }
}

void World::measure() {
  const ChassisState chassis = vehicle_.chassis();
  const Eigen::Vector3d velocity = imu_velocity(chassis);
  const Eigen::Matrix3d rotation = chassis.pose.linear();
  if (!velocity.allFinite() || !chassis.pose.translation().allFinite() ||
      velocity.norm() > 1000.0) {
    throw RunError("the physics diverged at " + std::to_string(time_s()) +
                   " s; a smaller [physics] step may help");
  }
  ImuTruth truth;
  truth.mean_rate_rad_per_s = rate_sum_ / steps_per_tick_;
  truth.mean_specific_force = rotation.transpose() * ((velocity - last_imu_velocity_) / kTick_s +
                                                      kGravity_m_per_s2 * Eigen::Vector3d::UnitZ());
  truth.body_to_world = rotation;
  truth.altitude_m = chassis.pose.translation().z();
  last_imu_velocity_ = velocity;
  imu_.measure(truth, sample_);

  const auto counts = [&](Side side) {
    const double turns = vehicle_.shaft_angle_rad(side) / (2.0 * std::numbers::pi);
    return static_cast<uint16_t>(
        static_cast<int64_t>(std::floor(turns * options_.encoder_counts_per_turn)) & 0xFFFF);
  };
  sample_.encoder_left = counts(kLeft);
  sample_.encoder_right = counts(kRight);
  sample_.battery = static_cast<uint16_t>(std::clamp(
      std::round(battery_.terminal_v * 1e6 / board_.battery_uv_per_lsb), 0.0, 8.0 * 1023.0));
  sample_.time_us = static_cast<uint32_t>(now_us());
}

void World::exchange_radio() {
  uplink_.send(now_us(), ground_.transmit(now_us()));
  const std::vector<uint8_t> arrived = uplink_.receive(now_us(), kRadioInCapacity);
  sample_.radio_in_count = static_cast<uint8_t>(arrived.size());
  std::fill(std::copy(arrived.begin(), arrived.end(), sample_.radio_in),
            sample_.radio_in + kRadioInCapacity, static_cast<uint8_t>(0));
  ground_.receive(now_us(), downlink_.receive(now_us(), SIZE_MAX));
}

void World::advance() {
  ++ticks_;
  if (options_.lay_on_side_at_s.has_value() &&
      ticks_ == static_cast<uint64_t>(std::llround(*options_.lay_on_side_at_s * kTickRate_hz))) {
    lay_on_side();
  }
  step_physics();
  measure();
  exchange_radio();
}

void World::apply(const RobotOutput& output) {
  duty_ = {std::clamp<int16_t>(output.duty_left, -kDutyMax, kDutyMax),
           std::clamp<int16_t>(output.duty_right, -kDutyMax, kDutyMax)};
  downlink_.send(now_us(), {output.radio_out, std::min(output.radio_out_count, kRadioOutCapacity)});
}

void World::lay_on_side() {
  Eigen::Isometry3d pose = vehicle_.chassis().pose;
  Attitude attitude = attitude_of(pose.linear());
  attitude.roll = -std::numbers::pi / 2.0;
  attitude.pitch = 0.0;
  pose.linear() = rotation_from(attitude);
  pose.translation().z() = vehicle_.resting_height(terrain_, pose.translation().x(),
                                                   pose.translation().y(), pose.linear());
  vehicle_.place(pose);
  // A hand, not an impact: the accelerometer sees the new attitude, no jerk.
  last_imu_velocity_.setZero();
}

}  // namespace screed
