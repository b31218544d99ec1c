// Frames, samples and outputs as rows of bytes: little endian, field by field, no padding.
//
// The same bytes are the row of the HDF5 table, the input of the content hash and what replay
// compares, so "recorded", "equal" and "same hash" cannot come to mean different things. Radio
// bytes behind the valid ones are always zero in a row.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"

// clang-format off
//  name            member          unit            meaning
#define SCREED_SAMPLE_COLUMNS(X) \
  X(time_us,        time_us,        "us",           "time of this tick since start, wraps") \
  X(gyro,           imu.gyro(),     "70 mdps",      "angular rate x, y, z in the robot frame") \
  X(accel,          imu.accel(),    "0.244 mg",     "specific force x, y, z in the robot frame") \
  X(mag,            imu.mag(),      "0.160 mG",     "magnetic field x, y, z in the robot frame") \
  X(pressure,       pressure,       "1/4096 hPa",   "air pressure") \
  X(temperature,    temperature,    "1/480 degC",   "temperature, from 42.5 degC") \
  X(encoder_left,   encoder_left,   "count",        "quadrature count, wraps") \
  X(encoder_right,  encoder_right,  "count",        "quadrature count, wraps") \
  X(battery,        battery,        "",             "sum of eight 10-bit conversions") \
  X(last_tick_us,   last_tick_us,   "us",           "computation time of the previous tick") \
  X(encoder_errors, encoder_errors, "count",        "missed quadrature edges, wraps") \
  X(fresh,          fresh,          "",             "devices with a new measurement: 1 gyro, 2 accel, 4 mag, 8 baro") \
  X(chips_failing,  chips_failing,  "", \
    "chips that do not answer or lost their settings: 1 LSM303D, 2 L3GD20H, 4 LPS25H") \
  X(bus_errors,     bus_errors,     "count",        "I2C transfers that failed, wraps") \
  X(radio_errors,   radio_errors,   "byte",         "received bytes that were lost, wraps") \
  X(reset_cause,    reset_cause,    "",             "why the program started, 0: power-on") \
  X(radio_in_count, radio_in_count, "byte",         "valid bytes of radio_in") \
  X(radio_in,       radio_in,       "",             "bytes received since the last tick")

#define SCREED_OUTPUT_COLUMNS(X) \
  X(duty_left,       "1/400",        "motor duty, -400..400") \
  X(duty_right,      "1/400",        "motor duty, -400..400") \
  X(leds,            "",             "lit LEDs: 1 yellow, 2 green, 4 red") \
  X(store_parameter, "",             "number of a parameter to store, from 1; 0: none") \
  X(store_value,     "",             "its value") \
  X(radio_out_count, "byte",         "valid bytes of radio_out") \
  X(radio_out,       "",             "bytes queued for the radio")
// clang-format on

namespace screed {

enum class ColumnType : std::uint8_t { kUint8, kInt16, kUint16, kInt32, kUint32, kDouble };

struct Column {
  const char* name;
  const char* unit;  ///< "" for counts, codes and bit sets
  const char* meaning;
  ColumnType type;
  std::uint16_t count;   ///< elements; 1 for a scalar
  bool array;            ///< true for an array, also one of one element
  std::uint16_t offset;  ///< of the first byte in a row
};

/// Bytes of one element.
constexpr std::uint16_t element_bytes(ColumnType type) {
  switch (type) {
    case ColumnType::kUint8:
      return 1;
    case ColumnType::kInt16:
    case ColumnType::kUint16:
      return 2;
    case ColumnType::kInt32:
    case ColumnType::kUint32:
      return 4;
    case ColumnType::kDouble:
      return 8;
  }
  return 0;
}

namespace record_detail {

template <class T>
constexpr ColumnType column_type() {
  using Element = std::remove_all_extents_t<T>;
  if constexpr (std::is_same_v<Element, std::uint8_t>) {
    return ColumnType::kUint8;
  } else if constexpr (std::is_same_v<Element, std::int16_t>) {
    return ColumnType::kInt16;
  } else if constexpr (std::is_same_v<Element, std::uint16_t>) {
    return ColumnType::kUint16;
  } else if constexpr (std::is_same_v<Element, std::int32_t>) {
    return ColumnType::kInt32;
  } else if constexpr (std::is_same_v<Element, std::uint32_t>) {
    return ColumnType::kUint32;
  } else {
    static_assert(std::is_same_v<Element, double>, "no column type for this member");
    return ColumnType::kDouble;
  }
}

template <class T>
constexpr Column make_column(const char* name, const char* unit, const char* meaning) {
  constexpr std::size_t kCount = std::is_array_v<T> ? std::extent_v<T> : 1;
  static_assert(kCount <= UINT16_MAX);
  return {name, unit, meaning, column_type<T>(), kCount, std::is_array_v<T>, 0};
}

template <std::size_t N>
constexpr std::array<Column, N> with_offsets(std::array<Column, N> columns) {
  std::uint16_t offset = 0;
  for (Column& column : columns) {
    column.offset = offset;
    offset = static_cast<std::uint16_t>(offset + element_bytes(column.type) * column.count);
  }
  return columns;
}

}  // namespace record_detail

inline constexpr auto kFrameColumns = record_detail::with_offsets(std::to_array<Column>({
#define SCREED_COLUMN(type, name, unit, meaning) \
  record_detail::make_column<decltype(SimFrame::name)>(#name, unit, meaning),
    SCREED_FRAME_COLUMNS(SCREED_COLUMN)
#undef SCREED_COLUMN
}));

inline constexpr auto kSampleColumns = record_detail::with_offsets(std::to_array<Column>({
#define SCREED_COLUMN(name, member, unit, meaning)                                            \
  record_detail::make_column<                                                                 \
      std::remove_reference_t<decltype((std::declval<SensorSample&>().member))>>(#name, unit, \
                                                                                 meaning),
    SCREED_SAMPLE_COLUMNS(SCREED_COLUMN)
#undef SCREED_COLUMN
}));

inline constexpr auto kOutputColumns = record_detail::with_offsets(std::to_array<Column>({
#define SCREED_COLUMN(name, unit, meaning) \
  record_detail::make_column<decltype(RobotOutput::name)>(#name, unit, meaning),
    SCREED_OUTPUT_COLUMNS(SCREED_COLUMN)
#undef SCREED_COLUMN
}));

/// Bytes of one row.
constexpr std::size_t row_bytes(std::span<const Column> columns) {
  const Column& last = columns.back();
  return std::size_t{last.offset} + std::size_t{element_bytes(last.type)} * last.count;
}

inline constexpr std::size_t kFrameBytes = row_bytes(kFrameColumns);
inline constexpr std::size_t kSampleBytes = row_bytes(kSampleColumns);
inline constexpr std::size_t kOutputBytes = row_bytes(kOutputColumns);

using FrameRow = std::span<std::uint8_t, kFrameBytes>;
using SampleRow = std::span<std::uint8_t, kSampleBytes>;
using OutputRow = std::span<std::uint8_t, kOutputBytes>;

void pack(const SimFrame& frame, FrameRow row);
void pack(const SensorSample& sample, SampleRow row);
void pack(const RobotOutput& output, OutputRow row);

void unpack(std::span<const std::uint8_t, kFrameBytes> row, SimFrame& frame);
void unpack(std::span<const std::uint8_t, kSampleBytes> row, SensorSample& sample);
void unpack(std::span<const std::uint8_t, kOutputBytes> row, RobotOutput& output);

/// A place in which two rows differ.
struct ColumnDifference {
  std::string column;  ///< "duty_left", or "gyro[2]" in an array
  std::string expected;
  std::string got;
};

/// All of them, in the order of the columns.
std::vector<ColumnDifference> column_differences(std::span<const Column> columns,
                                                 std::span<const std::uint8_t> expected,
                                                 std::span<const std::uint8_t> got);

/// Names the first column in which two rows differ, as "duty_left: expected 12, got 15"; nothing
/// when they are equal.
std::optional<std::string> first_difference(std::span<const Column> columns,
                                            std::span<const std::uint8_t> expected,
                                            std::span<const std::uint8_t> got);

}  // namespace screed
