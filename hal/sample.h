// The data that crosses the hardware abstraction layer: raw counts in, raw commands out.
//
// Everything here is plain data with fixed-width members, the same on the ATmega32U4 and on the
// host, so that a recorded sample replays bit for bit. Units are those of the hardware (counts,
// LSB, duty steps, microseconds): quantisation happens below this line on both sides, never in the
// firmware core.
#pragma once

#include <stdint.h>

#include "schema/values.h"

namespace screed {

/// Control ticks per second, a compile-time constant of the whole project.
constexpr uint8_t kTickRate_hz = 100;
constexpr uint16_t kTickPeriod_us = 10000;

/// Most bytes the radio can have received between two ticks: 57,600 baud is 57.6 bytes a tick; the
/// rest is slack for jitter.
constexpr uint8_t kRadioInCapacity = 64;
/// Most bytes the core hands to the radio in one tick: a packet of four whole telemetry lines of 22
/// bytes. The next tick has none: they take 15.3 ms.
constexpr uint8_t kRadioOutCapacity = 88;

/// Bits of SensorSample::fresh: the device delivered a new measurement since the last tick.
enum FreshBit : uint8_t {
  kFreshGyro = 1 << 0,
  kFreshAccel = 1 << 1,
  kFreshMag = 1 << 2,
  kFreshBaro = 1 << 3,
};

/// Most that SensorSample::battery can be: eight conversions at the end of their range.
constexpr uint16_t kBatteryMax = 8 * 1023;

/// Bits of SensorSample::chips_failing: the chip does not answer, or does not hold its settings.
using ChipBit = message::HealthConditions;

/// What the IMU measures, as nine counts and by its parts: x, y, z in the robot frame (x forward,
/// y left, z up).
struct ImuCounts {
  static constexpr uint8_t kSize = 9;
  int16_t all[kSize];

  using Axes = int16_t[3];
  Axes& gyro() { return axes(0); }  ///< 70 mdps/LSB
  const Axes& gyro() const { return axes(0); }
  Axes& accel() { return axes(3); }  ///< specific force, 0.244 mg/LSB: +z at rest when level
  const Axes& accel() const { return axes(3); }
  Axes& mag() { return axes(6); }  ///< 0.160 mG/LSB
  const Axes& mag() const { return axes(6); }

 private:
  // Members would read the same, and cost the AVR 90 bytes: there the nine counts are one array.
  Axes& axes(uint8_t from) { return *reinterpret_cast<Axes*>(all + from); }
  const Axes& axes(uint8_t from) const { return *reinterpret_cast<const Axes*>(all + from); }
};

/// What the robot knows of the world at one tick.
struct SensorSample {
  uint32_t time_us;  ///< time of this tick since start, wraps after 71.6 minutes
  ImuCounts imu;
  int32_t pressure;        ///< LPS25H, 1/4096 hPa/LSB, 24 bits
  int16_t temperature;     ///< LPS25H, 42.5 degC + raw/480
  uint16_t encoder_left;   ///< quadrature count, wraps; rises when the left track drives forward
  uint16_t encoder_right;  ///< as encoder_left
  uint16_t battery;        ///< sum of eight 10-bit conversions of the divided battery voltage
  uint16_t last_tick_us;   ///< how long the previous tick's computation took
  uint8_t encoder_errors;  ///< missed quadrature edges since start, both sides, wraps
  uint8_t fresh;           ///< FreshBit set
  uint8_t chips_failing;   ///< ChipBit set
  uint8_t bus_errors;      ///< I2C transfers that failed, wraps
  uint8_t radio_errors;    ///< received bytes that were lost, wraps
  uint8_t reset_cause;     ///< why the program started: message::HealthResetCause
  uint8_t radio_in_count;  ///< valid bytes in radio_in
  uint8_t radio_in[kRadioInCapacity];
};

/// Duty range of the motor drivers: -400..400, positive drives the track forward.
constexpr int16_t kDutyMax = 400;

/// Bits of RobotOutput::leds.
enum LedBit : uint8_t {
  kLedYellow = 1 << 0,
  kLedGreen = 1 << 1,
  kLedRed = 1 << 2,
};

/// What the robot does to the world after one tick.
struct RobotOutput {
  int16_t duty_left;   ///< -kDutyMax..kDutyMax
  int16_t duty_right;  ///< -kDutyMax..kDutyMax
  uint8_t leds;        ///< LedBit set
  /// A parameter to keep over restarts: its number in the table, from 1; 0: none. At most one in
  /// 1.5 s: an EEPROM is slow.
  uint8_t store_parameter;
  int16_t store_value;
  uint8_t radio_out_count;
  uint8_t radio_out[kRadioOutCapacity];  ///< whole lines only
};

}  // namespace screed
