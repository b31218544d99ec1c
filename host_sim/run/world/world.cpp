// A world of robots: their devices, native brains, and the step of all.
#include "host_sim/run/world/world.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <utility>

#include "firmware/main_loop.h"
#include "hal/sample.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/run/world/image_robot.h"

namespace screed {

uint64_t seed_of_robot(uint64_t seed, size_t number) {
  if (number == 0) return seed;
  WorldRandom random(seed, "robot " + std::to_string(number));
  const uint64_t high = random.next();
  return high << 32U | random.next();
}

Parameters parameters_of_robot(const Parameters& parameters, size_t number) {
  // Far from the seeds that a user counts up; no two robots of a world get the same.
  constexpr uint64_t kStride = 1009;
  constexpr uint64_t kSeeds = 32768;
  Parameters own = parameters;
  own.random_seed() = static_cast<int16_t>(
      (static_cast<uint64_t>(parameters.random_seed()) + kStride * number) % kSeeds);
  return own;
}

CommandKey key_of_robot(const CommandKey& key, size_t number) {
  CommandKey own = key;
  own.robot_id = static_cast<uint8_t>(key.robot_id + number);
  return own;
}

Credentials credentials_of_robot(const Credentials& credentials, size_t number) {
  Credentials own = credentials;
  own.robot_id = static_cast<uint8_t>(credentials.robot_id + number);
  return own;
}

namespace {

Eigen::Vector3d robot_position(const RobotView& robot) {
  return robot.vehicle().chassis().pose.translation();
}

double encoder_counts(const RobotView& robot, Side side, double counts_per_turn) {
  const double turns = robot.vehicle().shaft_angle_rad(side) / (2.0 * std::numbers::pi);
  return turns * counts_per_turn;
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
      lay_on_side_tick_(tick_at(own.lay_on_side_at_s)) {
  ground_.change(own.changes);
}

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
  return encoder_counts(robot, side, encoder_counts_per_turn_);
}

void measure_drive(const RobotView& robot, double counts_per_turn, const BoardConstants& board,
                   SensorSample& sample) {
  const auto counts = [&](Side side) {
    return static_cast<uint16_t>(
        static_cast<int64_t>(std::floor(encoder_counts(robot, side, counts_per_turn))) & 0xFFFF);
  };
  sample.encoder_left = counts(kLeft);
  sample.encoder_right = counts(kRight);
  sample.battery = static_cast<uint16_t>(
      std::clamp(std::round(robot.battery().terminal_v * 1e6 / board.battery_uv_per_lsb), 0.0,
                 double{kBatteryMax}));
}

// Sensors, radio and motors of a native robot, tick by tick.

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
  measure_drive(robot(), devices().encoder_counts_per_turn(), settings().board, measured_);
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

World::World(std::unique_ptr<Environment> plant, const WorldOptions& options)
    : plant_(std::move(plant)), duty_ratios_(plant_->robots()) {
  if (options.robots.size() != plant_->robots()) {
    throw InputError("a world of " + std::to_string(plant_->robots()) + " robots with options of " +
                     std::to_string(options.robots.size()) + "; as many are needed");
  }
  for (size_t i = 0; i < plant_->robots(); ++i) {
    robots_.push_back(options.robots[i].image.has_value()
                          ? make_image_robot(options, *plant_, i)
                          : std::make_unique<NativeRobot>(options, *plant_, i));
  }
}

void World::step() {
  if (plant_->steps() == ticks_ * static_cast<uint64_t>(plant_->steps_per_tick())) {
    ++ticks_;
    for (const auto& robot : robots_) robot->begin_tick(ticks_);
  }
  for (size_t i = 0; i < robots_.size(); ++i) duty_ratios_[i] = robots_[i]->duty_ratio();
  plant_->step(duty_ratios_);
  for (const auto& robot : robots_) robot->end_step();
}

bool World::advance(RobotWatch* watch) {
  std::vector<bool> answered(robots_.size(), false);
  do {
    step();
    for (size_t i = 0; i < robots_.size(); ++i) {
      const RobotController::Progress progress = robots_[i]->live(watch);
      if (progress == RobotController::Progress::kOver) return false;
      if (progress == RobotController::Progress::kAnswered) answered[i] = true;
    }
  } while (std::find(answered.begin(), answered.end(), false) != answered.end());
  return true;
}

}  // namespace screed
