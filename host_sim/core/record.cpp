// Packs and unpacks the rows; the column lists in record.h decide what and in which order.
#include "host_sim/core/record.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <utility>

namespace screed {
namespace {

template <class T>
auto to_bits(T value) {
  if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<std::uint64_t>(value);
  } else {
    return static_cast<std::make_unsigned_t<T>>(value);
  }
}

template <class T>
void store(T value, std::uint8_t*& cursor) {
  const auto bits = to_bits(value);
  for (std::size_t i = 0; i < sizeof(T); ++i)
    *cursor++ = static_cast<std::uint8_t>(bits >> (8 * i));
}

template <class T, std::size_t N>
void store(const T (&values)[N], std::uint8_t*& cursor) {
  for (const T value : values) store(value, cursor);
}

template <class T>
void load(const std::uint8_t*& cursor, T& value) {
  using Bits = decltype(to_bits(value));
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) bits |= std::uint64_t{*cursor++} << (8 * i);
  if constexpr (std::is_same_v<T, double>) {
    value = std::bit_cast<double>(bits);
  } else {
    value = static_cast<T>(static_cast<Bits>(bits));
  }
}

template <class T, std::size_t N>
void load(const std::uint8_t*& cursor, T (&values)[N]) {
  for (T& value : values) load(cursor, value);
}

/// Whatever stands behind the valid bytes is left over from earlier ticks and means nothing.
void zero_behind(std::size_t valid, std::size_t capacity, std::uint8_t* end) {
  const std::size_t unused = capacity - std::min(valid, capacity);
  std::memset(end - unused, 0, unused);
}

template <class T>
std::string number(const std::uint8_t* bytes) {
  T value{};
  load(bytes, value);
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string element_text(ColumnType type, const std::uint8_t* bytes) {
  switch (type) {
    case ColumnType::kUint8:
      return number<std::uint8_t>(bytes);
    case ColumnType::kInt16:
      return number<std::int16_t>(bytes);
    case ColumnType::kUint16:
      return number<std::uint16_t>(bytes);
    case ColumnType::kInt32:
      return number<std::int32_t>(bytes);
    case ColumnType::kUint32:
      return number<std::uint32_t>(bytes);
    case ColumnType::kDouble:
      return number<double>(bytes);
  }
  return {};
}

// A member added to hal/sample.h breaks these bindings: add it to the column lists of record.h as
// well.
[[maybe_unused]] void every_member_has_a_column(const SensorSample& sample,
                                                const RobotOutput& output) {
  [[maybe_unused]] const auto& [a1, a2, a3, a4, a5, a6, a7, a8, a9, a10, a11, a12, a13, a14, a15,
                                a16] = sample;
  [[maybe_unused]] const auto& [b1, b2, b3, b4, b5, b6, b7] = output;
  static_assert(kSampleColumns.size() == 18, "the IMU has three");
  static_assert(kOutputColumns.size() == 7);
}

}  // namespace

void pack(const SimFrame& frame, FrameRow row) {
  std::uint8_t* cursor = row.data();
#define SCREED_STORE(type, name, unit, meaning) store(frame.name, cursor);
  SCREED_FRAME_COLUMNS(SCREED_STORE)
#undef SCREED_STORE
}

void pack(const SensorSample& sample, SampleRow row) {
  std::uint8_t* cursor = row.data();
#define SCREED_STORE(name, member, unit, meaning) store(sample.member, cursor);
  SCREED_SAMPLE_COLUMNS(SCREED_STORE)
#undef SCREED_STORE
  zero_behind(sample.radio_in_count, kRadioInCapacity, cursor);
}

void pack(const RobotOutput& output, OutputRow row) {
  std::uint8_t* cursor = row.data();
#define SCREED_STORE(name, unit, meaning) store(output.name, cursor);
  SCREED_OUTPUT_COLUMNS(SCREED_STORE)
#undef SCREED_STORE
  zero_behind(output.radio_out_count, kRadioOutCapacity, cursor);
}

void unpack(std::span<const std::uint8_t, kFrameBytes> row, SimFrame& frame) {
  const std::uint8_t* cursor = row.data();
#define SCREED_LOAD(type, name, unit, meaning) load(cursor, frame.name);
  SCREED_FRAME_COLUMNS(SCREED_LOAD)
#undef SCREED_LOAD
}

void unpack(std::span<const std::uint8_t, kSampleBytes> row, SensorSample& sample) {
  const std::uint8_t* cursor = row.data();
#define SCREED_LOAD(name, member, unit, meaning) load(cursor, sample.member);
  SCREED_SAMPLE_COLUMNS(SCREED_LOAD)
#undef SCREED_LOAD
}

void unpack(std::span<const std::uint8_t, kOutputBytes> row, RobotOutput& output) {
  const std::uint8_t* cursor = row.data();
#define SCREED_LOAD(name, unit, meaning) load(cursor, output.name);
  SCREED_OUTPUT_COLUMNS(SCREED_LOAD)
#undef SCREED_LOAD
}

std::vector<ColumnDifference> column_differences(std::span<const Column> columns,
                                                 std::span<const std::uint8_t> expected,
                                                 std::span<const std::uint8_t> got) {
  std::vector<ColumnDifference> differences;
  for (const Column& column : columns) {
    const std::size_t size = element_bytes(column.type);
    for (std::size_t i = 0; i < column.count; ++i) {
      const std::size_t at = column.offset + i * size;
      if (std::memcmp(&expected[at], &got[at], size) == 0) continue;
      std::string name = column.name;
      if (column.array) name += "[" + std::to_string(i) + "]";
      differences.push_back({std::move(name), element_text(column.type, &expected[at]),
                             element_text(column.type, &got[at])});
    }
  }
  return differences;
}

std::optional<std::string> first_difference(std::span<const Column> columns,
                                            std::span<const std::uint8_t> expected,
                                            std::span<const std::uint8_t> got) {
  const std::vector<ColumnDifference> all = column_differences(columns, expected, got);
  if (all.empty()) return std::nullopt;
  return all[0].column + ": expected " + all[0].expected + ", got " + all[0].got;
}

}  // namespace screed
