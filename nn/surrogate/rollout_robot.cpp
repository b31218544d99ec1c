#include "nn/surrogate/rollout_robot.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/run/experiment/board_table.h"

namespace screed::nn {
namespace {

ImuErrors imu_errors(const Experiment& experiment) {
  if (!experiment.sensors.noise) return ImuErrors::quiet();
  return experiment.sensors.calibrated ? ImuErrors{} : ImuErrors::uncalibrated();
}

}  // namespace

RolloutRobot::RolloutRobot(const SessionInfo& info, const Experiment& experiment)
    : firmware_(info.board, info.parameters, info.credentials),
      imu_(experiment.experiment.seed, imu_errors(experiment)),
      counts_per_turn_(board_motor(info.board_name).counts_per_turn),
      volt_per_lsb_(info.board.battery_uv_per_lsb * 1e-6) {}

void RolloutRobot::follow(const SensorSample& recorded) {
  const ImuTruth at_rest{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(),
                         Eigen::Matrix3d::Identity(), 0.0};
  firmware_.tick(recorded, output_);
  SensorSample unused{};
  imu_.measure(at_rest, unused);  // so that its generators stand where they stood
}

SensorSample RolloutRobot::measure(const RobotView& robot, const SensorSample& recorded) {
  const auto counts = [&](Side side) {
    const double turns = robot.vehicle().shaft_angle_rad(side) / (2.0 * std::numbers::pi);
    return static_cast<std::uint16_t>(
        static_cast<std::int64_t>(std::floor(turns * counts_per_turn_)) & 0xFFFF);
  };
  SensorSample sample = recorded;
  imu_.measure(robot.motion(), sample);
  sample.encoder_left = counts(kLeft);
  sample.encoder_right = counts(kRight);
  sample.battery = static_cast<std::uint16_t>(
      std::clamp(std::round(robot.battery().terminal_v / volt_per_lsb_), 0.0, double{kBatteryMax}));
  return sample;
}

void RolloutRobot::tick(const RobotView& robot, const SensorSample& recorded) {
  firmware_.tick(measure(robot, recorded), output_);
}

std::array<double, 2> RolloutRobot::duty_ratio() const {
  return {static_cast<double>(output_.duty_left) / kDutyMax,
          static_cast<double>(output_.duty_right) / kDutyMax};
}

}  // namespace screed::nn
