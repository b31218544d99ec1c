// What surrounds a robot, tick by tick.
#include "host_sim/run/world/robot_devices.h"

#include <cmath>
#include <numbers>

#include "hal/sample.h"

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

RobotDevices::RobotDevices(const WorldOptions& options, const RobotView& robot,
                           std::ostream* telemetry_log)
    : imu_(options.seed, options.imu),
      uplink_(options.seed, "uplink", options.radio),
      downlink_(options.seed, "downlink", options.radio),
      ground_(options.ground_station_arms, options.drive, telemetry_log, options.ground_key,
              PositionFixes(options.seed, options.fixes)),
      ground_end_(options.ground_port),
      station_m_(robot_position(robot)),
      encoder_counts_per_turn_(options.encoder_counts_per_turn),
      lay_on_side_tick_(tick_at(options.lay_on_side_at_s)) {}

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
