// Samples and outputs as bytes on a serial line, for the host and the MCU alike: little endian, in
// the order of the members.
#pragma once

#include <stdint.h>

#include "hal/sample.h"

namespace screed {

template <typename Link>
void put_word(Link& link, uint16_t value) {
  link.put(static_cast<uint8_t>(value & 0xFFU));
  link.put(static_cast<uint8_t>(value >> 8));
}

template <typename Link>
uint16_t get_word(Link& link) {
  const uint8_t low = link.get();
  const uint8_t high = link.get();
  return static_cast<uint16_t>(low | static_cast<uint16_t>(static_cast<uint16_t>(high) << 8));
}

template <typename Link>
void put_long(Link& link, uint32_t value) {
  put_word(link, static_cast<uint16_t>(value & 0xFFFFU));
  put_word(link, static_cast<uint16_t>(value >> 16));
}

template <typename Link>
uint32_t get_long(Link& link) {
  const uint32_t low = get_word(link);
  return low | (static_cast<uint32_t>(get_word(link)) << 16);
}

template <typename Link>
void put_sample(Link& link, const SensorSample& sample) {
  put_long(link, sample.time_us);
  for (const int16_t value : sample.imu.gyro()) put_word(link, static_cast<uint16_t>(value));
  for (const int16_t value : sample.imu.accel()) put_word(link, static_cast<uint16_t>(value));
  for (const int16_t value : sample.imu.mag()) put_word(link, static_cast<uint16_t>(value));
  put_long(link, static_cast<uint32_t>(sample.pressure));
  put_word(link, static_cast<uint16_t>(sample.temperature));
  put_word(link, sample.encoder_left);
  put_word(link, sample.encoder_right);
  put_word(link, sample.battery);
  put_word(link, sample.last_tick_us);
  link.put(sample.encoder_errors);
  link.put(sample.fresh);
  link.put(sample.chips_failing);
  link.put(sample.bus_errors);
  link.put(sample.radio_errors);
  link.put(sample.reset_cause);
  link.put(sample.radio_in_count);
  for (uint8_t i = 0; i < sample.radio_in_count; ++i) link.put(sample.radio_in[i]);
}

template <typename Link>
void get_sample(Link& link, SensorSample& sample) {
  sample.time_us = get_long(link);
  for (int16_t& value : sample.imu.gyro()) value = static_cast<int16_t>(get_word(link));
  for (int16_t& value : sample.imu.accel()) value = static_cast<int16_t>(get_word(link));
  for (int16_t& value : sample.imu.mag()) value = static_cast<int16_t>(get_word(link));
  sample.pressure = static_cast<int32_t>(get_long(link));
  sample.temperature = static_cast<int16_t>(get_word(link));
  sample.encoder_left = get_word(link);
  sample.encoder_right = get_word(link);
  sample.battery = get_word(link);
  sample.last_tick_us = get_word(link);
  sample.encoder_errors = link.get();
  sample.fresh = link.get();
  sample.chips_failing = link.get();
  sample.bus_errors = link.get();
  sample.radio_errors = link.get();
  sample.reset_cause = link.get();
  sample.radio_in_count = link.get();
  for (uint8_t i = 0; i < sample.radio_in_count; ++i) sample.radio_in[i] = link.get();
}

template <typename Link>
void put_output(Link& link, const RobotOutput& output) {
  put_word(link, static_cast<uint16_t>(output.duty_left));
  put_word(link, static_cast<uint16_t>(output.duty_right));
  link.put(output.leds);
  link.put(output.store_parameter);
  put_word(link, static_cast<uint16_t>(output.store_value));
  link.put(output.radio_out_count);
  for (uint8_t i = 0; i < output.radio_out_count; ++i) link.put(output.radio_out[i]);
}

}  // namespace screed
