// The robot's board on the bench.
#include "tests/mcu/bench.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "tests/mcu/images.h"
#include "tools/avr/stack/image_size.h"
#include "tools/avr/stack/stack_analysis.h"

namespace screed::mcu {
unsigned computed_stack() {
  std::ifstream in(kScreedListing);
  return avr_stack::analyze(avr_stack::Disassembly::read(in), {}).worst_case();
}

unsigned static_ram() {
  std::ifstream in(kScreedSizes);
  return avr_stack::read_image_size(in).static_ram;
}

Bench::Bench()
    : board(kScreedImage, read_wiring(kWiring), static_cast<std::uint16_t>(static_ram())),
      mcu(board.mcu),
      accel_mag(board.accel_mag),
      gyro(board.gyro),
      baro(*board.baro) {
  mcu.write_eeprom(kCredentialRecordAddress, credential_record(credentials_of(test_key())).bytes);
  board.set_battery_v(7.2);
  board.set_encoder(kLeft, left_count_);
  board.set_encoder(kRight, right_count_);
}

void Bench::measure() {
  const int noise = ms_ % 7 - 3;
  board.set_acceleration(0.244 * Eigen::Vector3d(noise, -noise, accel_z + noise));
  board.set_magnetic_field(0.160 * Eigen::Vector3d(noise, 1250, -2500 + noise));
  board.set_angular_rate(0.070 * Eigen::Vector3d(noise, 2 - noise, ms_ % 5 - 2));
  baro.measure(0x3F5678 / 4096.0, 42.5 + (0xD8DC - 0x10000) / 480.0);
}

int Bench::left_duty() const {
  return static_cast<int>(std::lround(400.0 * board.motor_duty_ratio(kLeft)));
}

int Bench::right_duty() const {
  return static_cast<int>(std::lround(400.0 * board.motor_duty_ratio(kRight)));
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
  ground_.handle_frame(last_frame(kIdHeartbeat));
  mcu.receive(ground_.command(op, argument));
  run_ms(50);
}

void Bench::set_parameter(Parameters::Number number, std::int16_t value) {
  ground_.handle_frame(last_frame(kIdHeartbeat));
  mcu.receive(ground_.parameter(number, value));
  run_ms(50);
}

void Bench::turn_left_encoder(bool forward) {
  left_count_ += forward ? 1 : -1;
  board.set_encoder(kLeft, left_count_);
}

void Bench::turn_right_encoder(bool forward) {
  right_count_ += forward ? 1 : -1;
  board.set_encoder(kRight, right_count_);
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
