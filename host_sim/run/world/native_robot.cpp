// Sensors, radio and motors of a native robot, tick by tick.
#include "host_sim/run/world/native_robot.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "host_sim/devices/sensors/calibration_motion.h"

namespace screed {

void NativeRobot::begin_tick(uint64_t tick) {
  end_of_tick_steps_ = robot().steps() + static_cast<uint64_t>(robot().steps_per_tick());
  devices().execute_events(tick, robot());
}

// The ground station sends before the robot receives.
void NativeRobot::end_step() {
  if (robot().steps() != end_of_tick_steps_) return;
  measure();
  devices().exchange_radio(world_us(), robot());
  receive_radio();
}

// Fields that only a microcontroller has (last_tick_us, errors, chips_failing, reset_cause) stay 0.
void NativeRobot::measure() {
  devices().imu().measure(
      calibration_motion_ ? calibration_motion(robot().time_s()) : robot().motion(), sample_);

  const auto counts = [&](Side side) {
    return static_cast<uint16_t>(
        static_cast<int64_t>(std::floor(devices().encoder_position(robot(), side))) & 0xFFFF);
  };
  sample_.encoder_left = counts(kLeft);
  sample_.encoder_right = counts(kRight);
  sample_.battery = static_cast<uint16_t>(
      std::clamp(std::round(robot().battery().terminal_v * 1e6 / board_.battery_uv_per_lsb), 0.0,
                 double{kBatteryMax}));
  sample_.time_us = static_cast<uint32_t>(world_us());
}

void NativeRobot::receive_radio() {
  const std::span<const uint8_t> arrived = devices().uplink().receive(world_us(), kRadioInCapacity);
  sample_.radio_in_count = static_cast<uint8_t>(arrived.size());
  std::fill(std::copy(arrived.begin(), arrived.end(), sample_.radio_in),
            sample_.radio_in + kRadioInCapacity, static_cast<uint8_t>(0));
}

void NativeRobot::apply(const RobotOutput& output) {
  const auto ratio = [](int16_t duty) {
    return static_cast<double>(std::clamp<int16_t>(duty, -kDutyMax, kDutyMax)) / kDutyMax;
  };
  duty_ratio_ = {ratio(output.duty_left), ratio(output.duty_right)};
  devices().downlink().send(
      world_us(), {output.radio_out, std::min(output.radio_out_count, kRadioOutCapacity)});
}

}  // namespace screed
