// The robot's board on the bench.
#include "tests/mcu/bench.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/mcu/images.h"
#include "tools/avr_stack/image_size.h"
#include "tools/avr_stack/stack_analysis.h"

namespace screed::mcu {
namespace {

struct Step {
  bool a;
  bool b;
};
/// A leads B.
constexpr Step kForward[4] = {{false, false}, {true, false}, {true, true}, {false, true}};

Step turn(int& phase, bool forward) {
  phase = (phase + (forward ? 1 : 3)) % 4;
  return kForward[phase];
}

}  // namespace

unsigned computed_stack() {
  std::ifstream in(kScreedListing);
  return avr_stack::analyze(avr_stack::Disassembly::read(in)).worst_case();
}

unsigned static_ram() {
  std::ifstream in(kScreedSizes);
  return avr_stack::read_image_size(in).static_ram;
}

Bench::Bench()
    : mcu(kScreedImage, static_cast<std::uint16_t>(static_ram())),
      accel_mag(mcu, 0x1D),
      gyro(mcu, 0x6B),
      baro(mcu, 0x5D) {
  power_up(accel_mag);
  power_up(gyro);
  power_up(baro);
  mcu.set_adc_mv(6, 2400);  // 7.2 V behind the divider
  for (const int bit : {4, 7, 1, 2}) mcu.set_pin('B', bit, false);
}

void Bench::power_up(I2cChip& chip) const {
  chip.registers.fill(0);
  chip.registers[0x0F] = &chip == &accel_mag ? 0x49 : &chip == &gyro ? 0xD7 : 0xBD;
  if (&chip == &accel_mag) {
    chip.registers[0x20] = 0x07;
    chip.registers[0x24] = 0x18;
    chip.registers[0x25] = 0x20;
    chip.registers[0x26] = 0x01;
  }
  if (&chip == &gyro) chip.registers[0x20] = 0x07;
}

void Bench::measure() {
  const int noise = ms_ % 7 - 3;
  accel_mag.registers[0x27] = 0x0F;
  accel_mag.set_vector(0x28, noise, -noise, accel_z + noise);
  accel_mag.registers[0x07] = 0x0F;
  accel_mag.set_vector(0x08, noise, 1250, -2500 + noise);
  gyro.registers[0x27] = 0x0F;
  gyro.set_vector(0x28, noise, 2 - noise, ms_ % 5 - 2);
  baro.registers[0x27] = 0x03;
  baro.set_vector(0x28, 0x5678, 0xDC3F, 0x00D8);  // pressure 0x3F5678, temperature 0xD8DC
}

int Bench::left_duty() const {
  const int duty = mcu.word(kOcr1a);
  return (mcu.memory(kPortD) & 0x40) != 0 ? -duty : duty;
}

int Bench::right_duty() const {
  const int duty = mcu.word(kOcr1b);
  return (mcu.memory(kPortE) & 0x04) != 0 ? -duty : duty;
}

void Bench::turn_tracks() {
  // 0.25 m/s at full duty, 565.5 um a count.
  constexpr double kCountsPerMsAndDuty = 0.25 / 565.5e-6 / 1000 / 400;
  if (tracks_blocked) return;
  const double pushed = tracks_pushed_mm_per_s / 0.5655 / 1000;
  left_travel_ += pushed + kCountsPerMsAndDuty * left_duty();
  right_travel_ += pushed + kCountsPerMsAndDuty * right_duty();
  if (std::abs(left_travel_) >= 1) {
    const bool forward = left_travel_ > 0;
    left_travel_ -= forward ? 1 : -1;
    turn_left_encoder(forward);
  }
  if (std::abs(right_travel_) >= 1) {
    const bool forward = right_travel_ > 0;
    right_travel_ -= forward ? 1 : -1;
    turn_right_encoder(forward);
  }
}

void Bench::run_ms(int ms) {
  for (int i = 0; i < ms; ++i, ++ms_) {
    measure();
    turn_tracks();
    if (ground_station && ms_ % 100 == 0) {
      mcu.receive(ground_.heartbeat(static_cast<std::uint32_t>(ms_)));
    }
    mcu.run_ms(1);
  }
}

void Bench::command(CommandOp op, DriveArgument argument) {
  mcu.receive(ground_.command(op, argument));
  run_ms(50);
}

void Bench::turn_left_encoder(bool forward) {
  const Step step = turn(left_phase_, forward);
  mcu.set_pin('B', 4, step.a);
  mcu.set_pin('B', 7, step.b);
}

void Bench::turn_right_encoder(bool forward) {
  const Step step = turn(right_phase_, forward);
  mcu.set_pin('B', 1, step.a);
  mcu.set_pin('B', 2, step.b);
}

std::vector<CanFrame> Bench::frames(std::uint16_t id) {
  const std::vector<std::uint8_t> news(mcu.sent().begin() + static_cast<std::ptrdiff_t>(looked_at_),
                                       mcu.sent().end());
  looked_at_ = mcu.sent().size();
  std::vector<CanFrame> result;
  for (const CanFrame& frame : frames_in(news)) {
    if (frame.id == id) result.push_back(frame);
  }
  return result;
}

CanFrame Bench::last_frame(std::uint16_t id) const {
  CanFrame last{};
  bool found = false;
  for (const CanFrame& frame : frames_in(mcu.sent())) {
    if (frame.id != id) continue;
    last = frame;
    found = true;
  }
  EXPECT_TRUE(found) << "no frame " << std::hex << id;
  return last;
}

}  // namespace screed::mcu
