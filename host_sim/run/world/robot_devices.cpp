// What surrounds a robot, tick by tick.
#include "host_sim/run/world/robot_devices.h"

#include <cmath>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/run/world/robot_number.h"

namespace screed {
namespace {

Eigen::Vector3d robot_position(const RobotView& robot) {
  return robot.vehicle().chassis().pose.translation();
}

std::optional<uint64_t> tick_at(const std::optional<double>& time_s) {
  if (!time_s.has_value()) return std::nullopt;
  return static_cast<uint64_t>(std::llround(*time_s * kTickRate_hz));
}

}  // namespace

RobotDevices::RobotDevices(const WorldOptions& options, size_t number, const RobotView& robot)
    : RobotDevices(options, options.robots[number], seed_of_robot(options.seed, number), robot) {}

RobotDevices::RobotDevices(const WorldOptions& options, const RobotOptions& own, uint64_t seed,
                           const RobotView& robot)
    : imu_(seed, options.imu),
      uplink_(seed, "uplink", options.radio),
      downlink_(seed, "downlink", options.radio),
      ground_(options.ground_station_arms, own.drive, own.telemetry_log, own.ground_key,
              PositionFixes(seed, options.fixes)),
      ground_end_(own.ground_port),
      station_m_(robot_position(robot)),
      encoder_counts_per_turn_(options.encoder_counts_per_turn),
      lay_on_side_tick_(tick_at(own.lay_on_side_at_s)) {}

void RobotDevices::execute_events(uint64_t tick, RobotView& robot) {
  if (lay_on_side_tick_ == tick) robot.lay_on_side();
}

void RobotDevices::exchange_radio(uint64_t now_us, const RobotView& robot) {
  const Eigen::Vector3d position = robot_position(robot);
  const double distance_m = (position - station_m_).norm();
  ground_.see_robot(position.x(), position.y());
  uplink_.set_distance(distance_m);
  downlink_.set_distance(distance_m);
  ground_end_.tick(now_us, ground_, uplink_, downlink_);
}

double RobotDevices::encoder_position(const RobotView& robot, Side side) const {
  const double turns = robot.vehicle().shaft_angle_rad(side) / (2.0 * std::numbers::pi);
  return turns * encoder_counts_per_turn_;
}

}  // namespace screed
