// One robot in one world of physics.
#include "host_sim/run/world/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/devices/sensors/calibration_motion.h"

namespace screed {
World::World(HeightField terrain, const Assembly& model, const BoardConstants& board,
             const WorldOptions& options, std::ostream* telemetry_log)
    : World(std::make_unique<Plant>(std::move(terrain), model, options), board, options,
            telemetry_log) {}

World::World(std::unique_ptr<Environment> plant, const BoardConstants& board,
             const WorldOptions& options, std::ostream* telemetry_log)
    : options_(options),
      board_(board),
      plant_(std::move(plant)),
      imu_(options.seed, options.imu),
      uplink_(options.seed, "uplink", options.radio),
      downlink_(options.seed, "downlink", options.radio),
      ground_(options.ground_station_arms, options.drive, telemetry_log, options.ground_key),
      ground_end_(options.ground_port),
      station_m_(plant_->vehicle().chassis().pose.translation()) {}

void World::step_physics() {
  const std::array<double, 2> share = {static_cast<double>(duty_[kLeft]) / kDutyMax,
                                       static_cast<double>(duty_[kRight]) / kDutyMax};
  for (int i = 0; i < plant_->steps_per_tick(); ++i) plant_->step(share);
}

void World::measure() {
  imu_.measure(options_.handled ? calibration_motion(time_s()) : plant_->motion(), sample_);

  const auto counts = [&](Side side) {
    const double turns = vehicle().shaft_angle_rad(side) / (2.0 * std::numbers::pi);
    return static_cast<uint16_t>(
        static_cast<int64_t>(std::floor(turns * options_.encoder_counts_per_turn)) & 0xFFFF);
  };
  sample_.encoder_left = counts(kLeft);
  sample_.encoder_right = counts(kRight);
  sample_.battery = static_cast<uint16_t>(std::clamp(
      std::round(battery().terminal_v * 1e6 / board_.battery_uv_per_lsb), 0.0, 8.0 * 1023.0));
  sample_.time_us = static_cast<uint32_t>(now_us());
}

void World::exchange_radio() {
  const Eigen::Vector3d offset = vehicle().chassis().pose.translation() - station_m_;
  uplink_.set_distance(offset.norm());
  downlink_.set_distance(offset.norm());
  ground_end_.tick(now_us(), ground_, uplink_, downlink_);
  const std::vector<uint8_t> arrived = uplink_.receive(now_us(), kRadioInCapacity);
  sample_.radio_in_count = static_cast<uint8_t>(arrived.size());
  std::fill(std::copy(arrived.begin(), arrived.end(), sample_.radio_in),
            sample_.radio_in + kRadioInCapacity, static_cast<uint8_t>(0));
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

}  // namespace screed
