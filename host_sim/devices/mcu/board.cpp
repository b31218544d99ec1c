// A board on the bench.
#include "host_sim/devices/mcu/board.h"

#include <algorithm>
#include <cstddef>
#include <cstring>

#include "firmware/parameters/parameter_store.h"
#include "hal/avr/trace_markers.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/record.h"

namespace screed::mcu {
namespace {

/// Channels of an encoder, A leads B when the count rises.
struct Levels {
  bool a;
  bool b;
};
constexpr std::array<Levels, 4> kLevels = {
    {{false, false}, {true, false}, {true, true}, {false, true}}};

std::uint8_t vector_of(PinName pin) {
  return pin.port == 'E' ? kInt6Vector : kPcint0Vector;
}

constexpr std::uint8_t kPwmOfA = 0x80;  // COM1A1, COM1A0 = 0: clear on match up, set down
constexpr std::uint8_t kPwmOfB = 0x20;

}  // namespace

Board::Board(const std::string& elf_path, const Wiring& wiring, std::uint16_t static_ram)
    : mcu(elf_path, static_ram), bus(mcu), accel_mag(bus), gyro(bus), wiring_(wiring) {
  if (wiring.has_barometer) baro.emplace(bus);
  mcu.watch_register(kGpior0, [this](std::uint8_t value) { on_mark(value); });
  mcu.on_interrupt(kTimer3CompaVector, [this] { on_tick(); });
  mcu.on_sleep([this] { on_sleep(); });
  const auto on_edge_interrupt = [this](std::uint8_t vector) {
    for (const Side side : {kLeft, kRight}) {
      Encoder& it = encoders_.at(side);
      if (!it.edge_at.has_value() || vector_of(wiring_.encoders.at(side).a) != vector) continue;
      constexpr std::uint64_t kResponse = 5;
      worst_latency_ = std::max(worst_latency_, mcu.cycle() - *it.edge_at + kResponse);
      it.edge_at.reset();
    }
  };
  mcu.on_interrupt(kPcint0Vector, [on_edge_interrupt] { on_edge_interrupt(kPcint0Vector); });
  mcu.on_interrupt(kInt6Vector, [on_edge_interrupt] { on_edge_interrupt(kInt6Vector); });
  for (const Side side : {kLeft, kRight}) drive_encoder(side);
  set_battery_v(7.2);
}

// ---- the world

void Board::drive_encoder(Side side) {
  const Encoder& encoder = encoders_.at(side);
  const Wiring::Encoder& pins = wiring_.encoders.at(side);
  Levels levels = kLevels.at(static_cast<std::size_t>(encoder.count & 3));
  if (wiring_.xored) levels.a = levels.a != levels.b;
  // B first: with xored wiring the interrupt comes from the first pin.
  if (!encoder.broken[1]) mcu.set_pin(pins.b, levels.b);
  if (!encoder.broken[0]) mcu.set_pin(pins.a, levels.a);
}

void Board::set_encoder(Side side, std::int64_t count) {
  Encoder& encoder = encoders_.at(side);
  if (!encoder.started) {
    encoder.started = true;
  } else if (count != encoder.count) {
    ++edges_;
    if (!encoder.broken[0] && !encoder.broken[1] && !encoder.edge_at.has_value()) {
      encoder.edge_at = mcu.cycle();
    }
  }
  encoder.count = count;
  drive_encoder(side);
}

void Board::break_encoder_wire(Side side, int channel) {
  encoders_.at(side).broken.at(static_cast<std::size_t>(channel)) = true;
  encoders_.at(side).edge_at.reset();
  const Wiring::Encoder& pins = wiring_.encoders.at(side);
  mcu.release_pin(channel == 0 ? pins.a : pins.b);
}

void Board::set_battery_v(double volt) {
  mcu.set_adc_mv(wiring_.adc_channel, volt * 1000.0 / wiring_.battery_divider);
}

Eigen::Vector3d Board::in_chip_axes(const Eigen::Vector3d& robot) const {
  Eigen::Vector3d chip;
  for (Eigen::Index i = 0; i < 3; ++i) {
    const Wiring::Axis axis = wiring_.axes.at(static_cast<std::size_t>(i));
    chip[axis.index] = axis.reversed ? -robot[i] : robot[i];
  }
  return chip;
}

void Board::set_acceleration(const Eigen::Vector3d& mg) {
  accel_mag.measure_accel(in_chip_axes(mg));
}
void Board::set_magnetic_field(const Eigen::Vector3d& mgauss) {
  accel_mag.measure_mag(in_chip_axes(mgauss));
}
void Board::set_angular_rate(const Eigen::Vector3d& dps) {
  gyro.measure(in_chip_axes(dps));
}

double Board::motor_duty_ratio(Side side) const {
  const Wiring::Motor& motor = wiring_.motors.at(side);
  const bool is_a = motor.pwm.bit == 5;
  const std::uint8_t compare_mode = mcu.memory(kTccr1a) & (is_a ? 0xC0 : 0x30);
  double ratio = mcu.drives_high(motor.pwm) ? 1.0 : 0.0;  // the pin as plain output
  if (compare_mode == (is_a ? kPwmOfA : kPwmOfB)) {
    const std::uint16_t top = mcu.word(kIcr1);
    const std::uint16_t compare = mcu.word(is_a ? kOcr1a : kOcr1b);
    ratio = top == 0 ? 0.0 : std::min(1.0, static_cast<double>(compare) / top);
    // A pin that is no output drives nothing: the driver's pull-down holds.
    if (!mcu.drives_high(motor.pwm) && !mcu.drives_low(motor.pwm)) ratio = 0.0;
  }
  return mcu.drives_high(motor.direction) ? -ratio : ratio;
}

std::uint8_t Board::leds() const {
  std::uint8_t lit = 0;
  for (std::size_t i = 0; i < wiring_.leds.size(); ++i) {
    const Wiring::Led& led = wiring_.leds.at(i);
    if (led.lit_high ? mcu.drives_high(led.pin) : mcu.drives_low(led.pin)) {
      lit = static_cast<std::uint8_t>(lit | 1U << i);
    }
  }
  return lit;
}

// ---- the program

void Board::on_mark(std::uint8_t value) {
  const auto address = static_cast<std::uint16_t>(mcu.memory(kGpior1) | mcu.memory(kGpior2) << 8);
  switch (value) {
    case avr::kMarkerStart:
      ++programs_started_;
      mark_ = Mark::kStart;
      if (address + sizeof(Parameters) <= kRamEnd) {
        std::array<std::uint8_t, sizeof(Parameters)> bytes{};
        mcu.read_memory(address, bytes);
        std::memcpy(&parameters_, bytes.data(), bytes.size());
      }
      break;
    case avr::kMarkerSample: {
      // An AVR puts no gaps between members, and the columns stand in their order: an object in its
      // memory is a row of a session as it is.
      std::array<std::uint8_t, kSampleBytes> row{};
      if (address + row.size() > kRamEnd) return;
      mcu.read_memory(address, row);
      unpack(row, sample_);
      mark_ = Mark::kSample;
      const auto count = [&](Side side, std::uint16_t counted) {
        Encoder& it = encoders_.at(side);
        if (!it.counting) {
          it.counting = true;
          it.first_counted = counted;
          it.first = it.count;
        }
        it.count_at_sample = it.count;
        it.counted += static_cast<std::int16_t>(static_cast<std::uint16_t>(
            counted - static_cast<std::uint16_t>(it.first_counted + it.counted)));
      };
      count(kLeft, sample_.encoder_left);
      count(kRight, sample_.encoder_right);
      break;
    }
    case avr::kMarkerOutput: {
      std::array<std::uint8_t, kOutputBytes> row{};
      if (address + row.size() > kRamEnd) return;
      mcu.read_memory(address, row);
      unpack(row, output_);
      mark_ = Mark::kOutput;
      tick_answered_ = true;
      break;
    }
    default:
      return;
  }
  mcu.request_stop();
}

Board::Mark Board::take_mark() {
  const Mark mark = mark_;
  mark_ = Mark::kNone;
  return mark;
}

void Board::check() const {
  if (!mcu.alive()) {
    throw RunError("the image crashed or stopped after " + std::to_string(mcu.time_ms()) + " ms" +
                   (mcu.last_message().empty() ? "" : ": " + mcu.last_message()));
  }
  if (programs_started_ > mcu.starts()) {
    throw RunError("the image started anew without a reset after " + std::to_string(mcu.time_ms()) +
                   " ms: an interrupt without a handler, or a jump to address 0");
  }
  for (const I2cChip* const chip :
       {static_cast<const I2cChip*>(&accel_mag), static_cast<const I2cChip*>(&gyro),
        static_cast<const I2cChip*>(baro.has_value() ? &*baro : nullptr)}) {
    if (chip != nullptr && chip->failure().has_value()) throw RunError(*chip->failure());
  }
}

// ---- time

void Board::on_tick() {
  if (tick_began_.has_value()) {
    ++missed_ticks_;
    return;
  }
  tick_began_ = mcu.cycle();
  tick_answered_ = false;
}

void Board::on_sleep() {
  if (!tick_began_.has_value() || !tick_answered_) return;
  const std::uint64_t length = mcu.cycle() - *tick_began_;
  tick_began_.reset();
  ++ticks_;
  tick_cycles_ += length;
  longest_tick_ = std::max(longest_tick_, length);
}

CycleReport Board::cycles() const {
  CycleReport report;
  report.ticks = ticks_;
  report.longest_tick_cycles = longest_tick_;
  report.mean_tick_cycles =
      ticks_ == 0 ? 0.0 : static_cast<double>(tick_cycles_) / static_cast<double>(ticks_);
  report.missed_ticks = missed_ticks_;
  report.load = mcu.cycle() == 0 ? 0.0
                                 : 1.0 - static_cast<double>(mcu.slept_cycles()) /
                                             static_cast<double>(mcu.cycle());
  for (std::uint8_t vector = 1; vector < kVectors; ++vector) {
    const InterruptTimes& times = mcu.interrupts().at(vector);
    if (times.count == 0) continue;
    report.interrupts.push_back(
        {vector_name(vector), times.count, times.longest_cycles,
         static_cast<double>(times.all_cycles) / static_cast<double>(times.count)});
  }
  report.encoder_latency_cycles = worst_latency_;
  report.encoder_edges = edges_;
  report.encoder_missing = 0;
  for (const Encoder& it : encoders_) {
    const std::int64_t short_of = it.count_at_sample - it.first - it.counted;
    report.encoder_missing += short_of < 0 ? -short_of : short_of;
  }
  report.uart_received = mcu.received_bytes();
  report.uart_overruns = mcu.overruns();
  report.uart_sent = mcu.sent_bytes();
  report.resets = mcu.starts() - 1;
  return report;
}

}  // namespace screed::mcu
