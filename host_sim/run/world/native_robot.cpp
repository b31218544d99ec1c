// Sensors, radio and motors of a native robot, tick by tick.
#include "host_sim/run/world/native_robot.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "firmware/main_loop.h"
#include "host_sim/devices/sensors/calibration_motion.h"

namespace screed {

NativeRobot::NativeRobot(const WorldOptions& options, Environment& plant, size_t number)
    : RobotController(options, plant, number),
      calibration_motion_(options.calibration_motion),
      firmware_(settings().board, settings().parameters, settings().credentials) {}

void NativeRobot::begin_tick(uint64_t tick) {
  end_of_tick_steps_ = plant().steps() + static_cast<uint64_t>(plant().steps_per_tick());
  devices().execute_events(tick, robot());
}

// The ground station sends before the robot receives.
void NativeRobot::end_step() {
  if (!at_end_of_tick()) return;
  measure();
  devices().exchange_radio(world_us(), robot());
  receive_radio();
}

// Fields that only a microcontroller has (last_tick_us, errors, chips_failing, reset_cause) stay 0.
void NativeRobot::measure() {
  devices().imu().measure(
      calibration_motion_ ? calibration_motion(plant().time_s()) : robot().motion(), measured_);

  const auto counts = [&](Side side) {
    return static_cast<uint16_t>(
        static_cast<int64_t>(std::floor(devices().encoder_position(robot(), side))) & 0xFFFF);
  };
  measured_.encoder_left = counts(kLeft);
  measured_.encoder_right = counts(kRight);
  measured_.battery = static_cast<uint16_t>(std::clamp(
      std::round(robot().battery().terminal_v * 1e6 / settings().board.battery_uv_per_lsb), 0.0,
      double{kBatteryMax}));
  measured_.time_us = static_cast<uint32_t>(world_us());
}

void NativeRobot::receive_radio() {
  const std::span<const uint8_t> arrived = devices().uplink().receive(world_us(), kRadioInCapacity);
  measured_.radio_in_count = static_cast<uint8_t>(arrived.size());
  std::fill(std::copy(arrived.begin(), arrived.end(), measured_.radio_in),
            measured_.radio_in + kRadioInCapacity, static_cast<uint8_t>(0));
}

RobotController::Progress NativeRobot::live(RobotWatch* watch) {
  if (!at_end_of_tick()) return Progress::kNoAnswer;
  offered_ = measured_;
  if (watch != nullptr && !watch->on_sample(number(), offered_)) return Progress::kOver;
  watch_ = watch;
  const hal::TargetScope scope(*this);
  tick_firmware(firmware_, sample_, output_);
  return Progress::kAnswered;
}

void NativeRobot::write_outputs(const RobotOutput& answer) {
  RobotOutput output = answer;
  if (watch_ != nullptr) watch_->on_output(number(), output);
  const auto ratio = [](int16_t duty) {
    return static_cast<double>(std::clamp<int16_t>(duty, -kDutyMax, kDutyMax)) / kDutyMax;
  };
  duty_ratio_ = {ratio(output.duty_left), ratio(output.duty_right)};
  devices().downlink().send(
      world_us(), {output.radio_out, std::min(output.radio_out_count, kRadioOutCapacity)});
}

}  // namespace screed
