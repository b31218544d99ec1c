// One board in one world.
#include "host_sim/run/world/mcu_world.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

#include "firmware/parameters/parameter_store.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/devices/sensors/calibration_motion.h"

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

McuWorld::McuWorld(HeightField terrain, const Assembly& model, const CoSimulationOptions& options,
                   std::ostream* telemetry_log)
    : options_(options),
      board_(options.elf, wiring_of(options.board)),
      plant_(std::move(terrain), model, options.world),
      devices_(options.world, plant_, telemetry_log),
      chip_clock_(options.world.seed, "chip clocks"),
      flood_bytes_(options.world.seed, "flood") {
  ParameterCopy copy{};
  encode_parameters(options.parameters, 1, copy);
  for (std::uint8_t i = 0; i < kParameterCopies; ++i) {
    board_.mcu.write_eeprom(parameter_copy_address(i), copy.bytes);
  }
  board_.mcu.write_eeprom(kCredentialRecordAddress, credential_record(options.credentials).bytes);
  for (const Side side : {kLeft, kRight}) {
    position_.at(side) = devices_.encoder_position(plant_, side);
    board_.set_encoder(side, static_cast<std::int64_t>(std::floor(position_.at(side))));
  }
  board_.set_battery_v(plant_.battery().terminal_v);
  board_.mcu.on_sent([this](std::uint8_t byte) { devices_.downlink().send(now_us(), {&byte, 1}); });
}

std::uint64_t McuWorld::us_at(std::uint64_t steps) const {
  return steps * kTickPeriod_us / static_cast<std::uint64_t>(plant_.steps_per_tick());
}

std::uint64_t McuWorld::now_us() const {
  return board_.mcu.cycle() / kCyclesPerUs;
}

void McuWorld::begin_tick() {
  devices_.execute_events(++ticks_, plant_);
  devices_.exchange_radio(us_at(plant_.steps()), plant_);
}

void McuWorld::begin_step() {
  if (plant_.steps() % static_cast<std::uint64_t>(plant_.steps_per_tick()) == 0) begin_tick();
  const std::uint64_t begin_us = us_at(plant_.steps());
  plant_.step({board_.motor_duty_ratio(kLeft), board_.motor_duty_ratio(kRight)});
  const std::uint64_t end_us = us_at(plant_.steps());
  step_begin_ = begin_us * kCyclesPerUs;
  step_end_ = end_us * kCyclesPerUs;
  motion_.reset();
  board_.set_battery_v(plant_.battery().terminal_v);

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
void McuWorld::add_edges(Side side) {
  const double from = position_.at(side);
  const double to = devices_.encoder_position(plant_, side);
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

void McuWorld::add_measurements(EventKind kind, Sampler& sampler, double rate_hz, double begin_us,
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

void McuWorld::add_radio(std::uint64_t begin_us, std::uint64_t end_us) {
  if (flood) {
    const double character_us =
        static_cast<double>(board_.mcu.cycles_per_character()) / static_cast<double>(kCyclesPerUs);
    flood_us_ = std::max(flood_us_, static_cast<double>(begin_us));
    for (; flood_us_ < static_cast<double>(end_us); flood_us_ += character_us) {
      events_.push_back({static_cast<std::uint64_t>(flood_us_ * static_cast<double>(kCyclesPerUs)),
                         EventKind::kRadioByte, kLeft, flood_bytes_.next() & 0xFFU});
    }
  }
  while (const std::optional<RadioLink::Byte> byte = devices_.uplink().receive_byte(end_us - 1)) {
    if (flood) continue;  // two senders at once: nothing gets through
    const std::uint64_t at_us = std::max(byte->arrives_us, begin_us);
    events_.push_back({at_us * kCyclesPerUs, EventKind::kRadioByte, kLeft, byte->value});
  }
}

void McuWorld::dispatch(const Event& event) {
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
    const double time_s =
        std::max(1.0 / kTickRate_hz, 1e-6 * static_cast<double>(us_at(plant_.steps())));
    motion_ = options_.world.calibration_motion ? calibration_motion(time_s) : plant_.motion();
  }
  switch (event.kind) {
    case EventKind::kAccel:
      board_.set_acceleration(devices_.imu().accel_mg(*motion_));
      break;
    case EventKind::kMag:
      board_.set_magnetic_field(devices_.imu().mag_mgauss(*motion_));
      break;
    case EventKind::kGyro:
      board_.set_angular_rate(devices_.imu().gyro_dps(*motion_));
      break;
    default:
      board_.baro->measure(devices_.imu().pressure_hpa(*motion_), ImuModel::kTemperature_degc);
      break;
  }
}

void McuWorld::run_to(Board::Mark mark) {
  const std::uint64_t limit_us = now_us() + kAnswerTimeout_us;
  for (;;) {
    const bool waiting = next_event_ < events_.size();
    const std::uint64_t target = waiting ? events_[next_event_].cycle : step_end_;
    const bool arrived = board_.mcu.run_to(target);
    board_.check();
    if (!arrived) {
      const Board::Mark shown = board_.take_mark();
      if (shown == Board::Mark::kStart &&
          std::memcmp(&board_.parameters(), &options_.parameters, sizeof(Parameters)) != 0) {
        throw RunError(options_.elf +
                       ": the image does not take the experiment's parameters; it was built for "
                       "another parameter table (run make firmware)");
      }
      if (shown == mark) return;
      continue;
    }
    if (waiting) {
      dispatch(events_[next_event_++]);
      continue;
    }
    if (now_us() > limit_us) {
      throw RunError("the image has made no control tick for 2 s, at " +
                     std::to_string(plant_.time_s()) + " s");
    }
    begin_step();
  }
}

const SensorSample& McuWorld::run_to_sample() {
  run_to(Board::Mark::kSample);
  return board_.sample();
}

const RobotOutput& McuWorld::run_to_output() {
  run_to(Board::Mark::kOutput);
  return board_.output();
}

}  // namespace screed::mcu

namespace screed {

std::unique_ptr<CoSimulation> make_co_simulation(HeightField terrain, const Assembly& model,
                                                 const CoSimulationOptions& options,
                                                 std::ostream* telemetry_log) {
  std::error_code error;
  if (!std::filesystem::exists(options.elf, error)) {
    throw InputError(options.elf + ": no such image; run make firmware BOARD=" + options.board);
  }
  return std::make_unique<mcu::McuWorld>(std::move(terrain), model, options, telemetry_log);
}

}  // namespace screed
