// What happens to a board in a physics step, and the microcontroller living through it.
#include "host_sim/run/world/mcu_robot.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "firmware/parameters/parameter_store.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/devices/mcu/mcu.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/run/experiment/vehicle_sections.h"
#include "host_sim/run/world/image_robot.h"

namespace screed::mcu {
namespace {

// No healthy program is silent for so long, not even through a reset by the watchdog.
constexpr std::uint64_t kAnswerTimeout_us = 2'000'000;

Wiring wiring_of(const std::string& board) {
  const std::filesystem::path folder = data_folders().boards / board;
  std::error_code error;
  if (board.empty() || !std::filesystem::is_directory(folder, error)) {
    throw InputError("board '" + board + "': no folder " + folder.string());
  }
  return read_wiring(folder / "wiring.ini");
}

}  // namespace

McuRobot::McuRobot(const WorldOptions& options, Environment& plant, std::size_t number)
    : RobotController(options, plant, number),
      elf_(options.robots[number].image->elf),
      board_(elf_, wiring_of(options.robots[number].image->board)),
      calibration_motion_(options.calibration_motion),
      chip_clock_(seed_of_robot(options.seed, number), "chip clocks"),
      flood_bytes_(seed_of_robot(options.seed, number), "flood") {
  store_in_eeprom();
  for (const Side side : {kLeft, kRight}) {
    position_.at(side) = devices().encoder_position(robot(), side);
    board_.set_encoder(side, static_cast<std::int64_t>(std::floor(position_.at(side))));
  }
  board_.set_battery_v(robot().battery().terminal_v);
  board_.mcu.on_sent([this](std::uint8_t byte) {
    devices().downlink().send(now_us(), {&byte, 1});
  });
  const std::optional<int> gdb_port = options.robots[number].image->gdb_port;
  if (gdb_port.has_value()) board_.mcu.wait_for_debugger(*gdb_port);
}

void McuRobot::store_in_eeprom() {
  ParameterCopy copy{};
  encode_parameters(settings().parameters, 1, copy);
  for (std::uint8_t i = 0; i < kParameterCopies; ++i) {
    board_.mcu.write_eeprom(parameter_copy_address(i), copy.bytes);
  }
  board_.mcu.write_eeprom(kCredentialRecordAddress,
                          credential_record(settings().credentials).bytes);
}

void McuRobot::begin_tick(uint64_t tick) {
  devices().execute_events(tick, robot());
  devices().exchange_radio(world_us(), robot());
}

DutyRatio McuRobot::duty_ratio() const {
  return {board_.motor_duty_ratio(kLeft), board_.motor_duty_ratio(kRight)};
}

void McuRobot::end_step() {
  const std::uint64_t begin_us = us_at(plant().steps() - 1);
  const std::uint64_t end_us = world_us();
  step_begin_ = begin_us * kCyclesPerUs;
  step_end_ = end_us * kCyclesPerUs;
  motion_.reset();
  board_.set_battery_v(robot().battery().terminal_v);

  events_.clear();
  next_event_ = 0;
  add_edges(kLeft);
  add_edges(kRight);
  const auto begin = static_cast<double>(begin_us);
  const auto end = static_cast<double>(end_us);
  add_measurements(EventKind::kAccel, samplers_[0], board_.accel_mag.accel_rate_hz(), begin, end);
  add_measurements(EventKind::kMag, samplers_[1], board_.accel_mag.mag_rate_hz(), begin, end);
  add_measurements(EventKind::kGyro, samplers_[2], board_.gyro.rate_hz(), begin, end);
  if (board_.baro.has_value()) {
    add_measurements(EventKind::kBaro, samplers_[3], board_.baro->rate_hz(), begin, end);
  }
  add_radio(begin_us, end_us);
  std::stable_sort(events_.begin(), events_.end(),
                   [](const Event& a, const Event& b) { return a.cycle < b.cycle; });
}

/// Edges stand where the shaft, turning evenly within the step, passes a whole count.
void McuRobot::add_edges(Side side) {
  const double from = position_.at(side);
  const double to = devices().encoder_position(robot(), side);
  position_.at(side) = to;
  const auto first = static_cast<std::int64_t>(std::floor(from));
  const auto last = static_cast<std::int64_t>(std::floor(to));
  const auto length = static_cast<double>(step_end_ - step_begin_);
  const bool forward = last > first;
  for (std::int64_t count = first; count != last;) {
    const auto boundary = static_cast<double>(forward ? count + 1 : count);
    count += forward ? 1 : -1;
    const double share = (boundary - from) / (to - from);
    std::uint64_t cycle = step_begin_ + static_cast<std::uint64_t>(share * length);
    // Two crossings of one edge are at least 1 us apart.
    cycle = std::max(cycle, last_edge_.at(side) + kCyclesPerUs);
    last_edge_.at(side) = cycle;
    events_.push_back({cycle, EventKind::kEdge, side, count});
  }
}

void McuRobot::add_measurements(EventKind kind, Sampler& sampler, double rate_hz, double begin_us,
                                double end_us) {
  if (rate_hz <= 0.0) {
    sampler.rate_hz = 0.0;
    return;
  }
  const double period_us = 1e6 / rate_hz;
  if (rate_hz != sampler.rate_hz) {
    sampler.rate_hz = rate_hz;
    sampler.next_us = begin_us + chip_clock_.uniform() * period_us;
  }
  for (; sampler.next_us < end_us; sampler.next_us += period_us) {
    const auto cycle = static_cast<std::uint64_t>(std::max(begin_us, sampler.next_us) *
                                                  static_cast<double>(kCyclesPerUs));
    events_.push_back({cycle, kind, kLeft, 0});
  }
}

void McuRobot::add_radio(std::uint64_t begin_us, std::uint64_t end_us) {
  if (flood) {
    const double character_us =
        static_cast<double>(board_.mcu.cycles_per_character()) / static_cast<double>(kCyclesPerUs);
    flood_us_ = std::max(flood_us_, static_cast<double>(begin_us));
    for (; flood_us_ < static_cast<double>(end_us); flood_us_ += character_us) {
      events_.push_back({static_cast<std::uint64_t>(flood_us_ * static_cast<double>(kCyclesPerUs)),
                         EventKind::kRadioByte, kLeft, flood_bytes_.next() & 0xFFU});
    }
  }
  while (const std::optional<RadioLink::Byte> byte = devices().uplink().receive_byte(end_us - 1)) {
    if (flood) continue;  // two senders at once: nothing gets through
    const std::uint64_t at_us = std::max(byte->arrives_us, begin_us);
    events_.push_back({at_us * kCyclesPerUs, EventKind::kRadioByte, kLeft, byte->value});
  }
}

void McuRobot::dispatch(const Event& event) {
  if (event.kind == EventKind::kEdge) {
    board_.set_encoder(event.side, event.value);
    return;
  }
  if (event.kind == EventKind::kRadioByte) {
    board_.mcu.receive_byte(static_cast<std::uint8_t>(event.value));
    return;
  }
  if (!motion_.has_value()) {
    // The motion begins with a tick.
    const double time_s = std::max(1.0 / kTickRate_hz, 1e-6 * static_cast<double>(world_us()));
    motion_ = calibration_motion_ ? calibration_motion(time_s) : robot().motion();
  }
  switch (event.kind) {
    case EventKind::kAccel:
      board_.set_acceleration(devices().imu().accel_mg(*motion_));
      break;
    case EventKind::kMag:
      board_.set_magnetic_field(devices().imu().mag_mgauss(*motion_));
      break;
    case EventKind::kGyro:
      board_.set_angular_rate(devices().imu().gyro_dps(*motion_));
      break;
    default:
      board_.baro->measure(devices().imu().pressure_hpa(*motion_), ImuModel::kTemperature_degc);
      break;
  }
}

void McuRobot::check_parameters() const {
  if (std::memcmp(&board_.parameters(), &settings().parameters, sizeof(Parameters)) == 0) return;
  throw RunError(elf_ +
                 ": the image does not take the experiment's parameters; it was built for another "
                 "parameter table (run make firmware)");
}

Board::Mark McuRobot::run_to_mark() {
  for (;;) {
    const bool waiting = next_event_ < events_.size();
    const std::uint64_t target = waiting ? events_[next_event_].cycle : step_end_;
    const bool arrived = board_.mcu.run_to(target);
    board_.check();
    if (!arrived) {
      const Board::Mark mark = board_.take_mark();
      if (mark == Board::Mark::kNone) continue;
      return mark;
    }
    if (!waiting) return Board::Mark::kNone;
    dispatch(events_[next_event_++]);
  }
}

RobotController::Progress McuRobot::live(RobotWatch* watch) {
  Progress progress = Progress::kNoAnswer;
  for (;;) {
    switch (run_to_mark()) {
      case Board::Mark::kNone:
        if (now_us() > last_mark_us_ + kAnswerTimeout_us) {
          throw RunError("the image has made no control tick for 2 s, at " +
                         std::to_string(plant().time_s()) + " s");
        }
        return progress;
      case Board::Mark::kStart:
        check_parameters();
        break;
      case Board::Mark::kSample:
        last_mark_us_ = now_us();
        sample_ = board_.sample();
        if (watch != nullptr && !watch->on_sample(number(), sample_)) return Progress::kOver;
        break;
      case Board::Mark::kOutput:
        last_mark_us_ = now_us();
        output_ = board_.output();
        if (watch != nullptr) watch->on_output(number(), output_);
        progress = Progress::kAnswered;
        break;
    }
  }
}

}  // namespace screed::mcu

namespace screed {
namespace {

/// The robot would refuse to be armed, and its shadow on this machine would not.
void check_algorithm(const std::string& elf, const Parameters& parameters) {
  const std::optional<std::uint16_t> in_image = mcu::image_algorithms(elf);
  const std::int16_t wanted = parameters.algorithm();
  if (!in_image.has_value() || (*in_image >> wanted & 1) != 0) return;
  const std::vector<std::string> names = algorithm_names();
  std::string has;
  for (size_t i = 0; i < names.size(); ++i)
    if ((*in_image >> i & 1) != 0) has += (has.empty() ? "" : ", ") + names[i];
  const std::string& name = names.at(static_cast<size_t>(wanted));
  throw InputError(elf + ": the image has no algorithm " + name + ", only " + has +
                   "; make firmware LEVELING=" + name + " builds one that has it, for --elf");
}

}  // namespace

void check_image(const RobotOptions& robot) {
  const RobotImage& image = *robot.image;
  std::error_code error;
  if (!std::filesystem::exists(image.elf, error)) {
    throw InputError(image.elf + ": no such image; run make firmware BOARD=" + image.board);
  }
  check_algorithm(image.elf, robot.settings.parameters);
}

std::unique_ptr<RobotController> make_image_robot(const WorldOptions& options, Environment& plant,
                                                  std::size_t number) {
  check_image(options.robots[number]);
  return std::make_unique<mcu::McuRobot>(options, plant, number);
}

}  // namespace screed
