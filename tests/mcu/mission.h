// A scripted mission as a sequence of samples: what a robot would measure while it waits, is armed,
// walks over hills, is given other parameters, hears garbage, loses its gyro and falls on its side,
// and at last reads nonsense. Made up, not simulated: it only has to lead the code everywhere.
#pragma once

#include <algorithm>
#include <vector>

#include "hal/sample.h"
#include "tests/mcu/golden_vectors.h"
#include "tests/mcu/ground_lines.h"

namespace screed::mcu {

class Mission {
 public:
  static constexpr int kTicks = 2700;
  static constexpr std::int16_t kWalkSpeedMax = 90;
  static constexpr std::int16_t kAccelLimit = 200;
  static constexpr std::int16_t kClimbThreshold = 300;

  SensorSample next() {
    const int tick = tick_++;
    sample_.time_us = static_cast<std::uint32_t>(tick) * kTickPeriod_us;
    const bool moving = tick > 400;
    const int pitch = moving ? slope(tick) : 0;  // accelerometer counts
    for (std::int16_t& value : sample_.imu.gyro()) value = numbers_.within(moving ? 300 : 3);
    sample_.imu.accel()[0] = static_cast<std::int16_t>(pitch + numbers_.within(10));
    sample_.imu.accel()[1] = numbers_.within(10);
    sample_.imu.accel()[2] = static_cast<std::int16_t>(4096 + numbers_.within(10));
    sample_.imu.mag()[0] = numbers_.within(20);
    sample_.imu.mag()[1] = static_cast<std::int16_t>(1250 + numbers_.within(20));
    sample_.imu.mag()[2] = static_cast<std::int16_t>(-2500 + numbers_.within(20));
    sample_.pressure = 4'150'000 + numbers_.within(100);
    sample_.temperature = static_cast<std::int16_t>(-9000 + numbers_.within(10));
    if (moving) {
      sample_.encoder_left = static_cast<std::uint16_t>(sample_.encoder_left + numbers_.any() % 2U);
      sample_.encoder_right =
          static_cast<std::uint16_t>(sample_.encoder_right + numbers_.any() % 2U);
    }
    sample_.battery = static_cast<std::uint16_t>(4000U + numbers_.any() % 30U);
    sample_.last_tick_us = static_cast<std::uint16_t>(2500U + numbers_.any() % 500U);
    sample_.fresh = kFreshGyro | kFreshAccel | kFreshMag;
    if (tick % 4 == 0) sample_.fresh |= kFreshBaro;
    if (tick % 97 == 0) sample_.fresh = 0;
    if (tick > 2300) {  // on its side
      std::swap(sample_.imu.accel()[1], sample_.imu.accel()[2]);
    }
    if (tick > 2400) babble();
    handle_frame(tick);
    return sample_;
  }

 private:
  static int slope(int tick) {  // up and down hills of 3 s
    const int phase = tick % 300;
    return (phase < 150 ? phase : 300 - phase) * 8 - 300;
  }

  /// Anything the devices can say.
  void babble() {
    for (std::int16_t& value : sample_.imu.gyro()) value = numbers_.narrow();
    for (std::int16_t& value : sample_.imu.accel()) value = numbers_.narrow();
    for (std::int16_t& value : sample_.imu.mag()) value = numbers_.narrow();
    sample_.pressure = numbers_.wide();
    sample_.temperature = numbers_.narrow();
    sample_.encoder_left = static_cast<std::uint16_t>(numbers_.wide());
    sample_.encoder_right = static_cast<std::uint16_t>(numbers_.wide());
    sample_.battery = static_cast<std::uint16_t>(numbers_.any() % 8185U);
    sample_.last_tick_us = static_cast<std::uint16_t>(numbers_.wide());
    sample_.fresh = static_cast<std::uint8_t>(numbers_.any() & 0x0FU);
    sample_.chips_failing = static_cast<std::uint8_t>(numbers_.any() & 0x07U);
    sample_.bus_errors = static_cast<std::uint8_t>(numbers_.any());
    sample_.radio_errors = static_cast<std::uint8_t>(numbers_.any());
    sample_.reset_cause = static_cast<std::uint8_t>(numbers_.any() & 0x0FU);
  }

  void handle_frame(int tick) {
    std::vector<std::uint8_t> bytes;
    const auto add = [&bytes](const std::vector<std::uint8_t>& line) {
      bytes.insert(bytes.end(), line.begin(), line.end());
    };
    if (tick % 10 == 0) add(ground_.heartbeat(static_cast<std::uint32_t>(tick) * 10U));
    if (tick == 450) add(ground_.command(CommandOp::kArm));
    if (tick == 460) add(ground_.command(CommandOp::kRun));
    // While it runs, of each part that keeps parameters one.
    if (tick == 701) add(ground_.parameter(Parameters::k_walk_speed_max, kWalkSpeedMax));
    if (tick == 961) add(ground_.parameter(Parameters::k_accel_limit, kAccelLimit));
    if (tick == 1211) add(ground_.parameter(Parameters::k_climb_threshold, kClimbThreshold));
    if (tick == 1500) add(ground_.command(CommandOp::kStop));
    if (tick == 1520) add(ground_.command(CommandOp::kDrive, {100, -300}));
    if (tick == 1600) add(ground_.command(CommandOp::kRun));
    if (tick % 33 == 0) {
      for (int i = 0; i < 20; ++i) bytes.push_back(static_cast<std::uint8_t>(numbers_.any() >> 24));
      bytes.push_back('\r');
    }
    bytes.resize(std::min<std::size_t>(bytes.size(), kRadioInCapacity));
    sample_.radio_in_count = static_cast<std::uint8_t>(bytes.size());
    std::copy(bytes.begin(), bytes.end(), sample_.radio_in);
  }

  SensorSample sample_{};
  GoldenNumbers numbers_;
  GroundLines ground_;
  int tick_ = 0;
};

}  // namespace screed::mcu
