// One robot in one world of physics.
#include "host_sim/run/world/world.h"

#include <algorithm>
#include <cmath>

#include "host_sim/devices/sensors/calibration_motion.h"

namespace screed {

World::World(HeightField terrain, const Assembly& model, const BoardConstants& board,
             const WorldOptions& options, std::ostream* telemetry_log)
    : World(std::make_unique<Plant>(std::move(terrain), model, options), board, options,
            telemetry_log) {}

World::World(std::unique_ptr<Environment> plant, const BoardConstants& board,
             const WorldOptions& options, std::ostream* telemetry_log)
    : calibration_motion_(options.calibration_motion),
      board_(board),
      plant_(std::move(plant)),
      devices_(options, *plant_, telemetry_log) {}

void World::step_physics() {
  const std::array<double, 2> duty_ratio = {static_cast<double>(duty_[kLeft]) / kDutyMax,
                                            static_cast<double>(duty_[kRight]) / kDutyMax};
  for (int i = 0; i < plant_->steps_per_tick(); ++i) plant_->step(duty_ratio);
}

// Fields that only a microcontroller has (last_tick_us, errors, chips_failing, reset_cause) stay 0.
void World::measure() {
  devices_.imu().measure(calibration_motion_ ? calibration_motion(time_s()) : plant_->motion(),
                         sample_);

  const auto counts = [this](Side side) {
    return static_cast<uint16_t>(
        static_cast<int64_t>(std::floor(devices_.encoder_position(*plant_, side))) & 0xFFFF);
  };
  sample_.encoder_left = counts(kLeft);
  sample_.encoder_right = counts(kRight);
  sample_.battery = static_cast<uint16_t>(
      std::clamp(std::round(battery().terminal_v * 1e6 / board_.battery_uv_per_lsb), 0.0,
                 double{kBatteryMax}));
  sample_.time_us = static_cast<uint32_t>(now_us());
}

void World::receive_radio() {
  const std::vector<uint8_t> arrived = devices_.uplink().receive(now_us(), kRadioInCapacity);
  sample_.radio_in_count = static_cast<uint8_t>(arrived.size());
  std::fill(std::copy(arrived.begin(), arrived.end(), sample_.radio_in),
            sample_.radio_in + kRadioInCapacity, static_cast<uint8_t>(0));
}

// The order matters: events before the physics of their tick; the ground station sends before the
// robot receives; the answer of the last tick (duty_) drives these physics steps.
void World::advance() {
  ++ticks_;
  devices_.execute_events(ticks_, *plant_);
  step_physics();
  measure();
  devices_.exchange_radio(now_us(), *plant_);
  receive_radio();
}

void World::apply(const RobotOutput& output) {
  duty_ = {std::clamp<int16_t>(output.duty_left, -kDutyMax, kDutyMax),
           std::clamp<int16_t>(output.duty_right, -kDutyMax, kDutyMax)};
  devices_.downlink().send(now_us(),
                           {output.radio_out, std::min(output.radio_out_count, kRadioOutCapacity)});
}

}  // namespace screed
