// Rows of samples and outputs as bytes.
#include "host_sim/core/record.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace screed {
namespace {

/// Where in an object the first byte lies that a column of its row sets.
template <class Object, std::size_t N>
std::size_t place_of(const Column& column) {
  std::array<std::uint8_t, N> row{};
  row[column.offset] = 1;
  Object object{};
  unpack(std::span<const std::uint8_t, N>(row), object);
  const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&object);
  return static_cast<std::size_t>(std::find(bytes, bytes + sizeof object, 1) - bytes);
}

// So objects in the memory of an AVR, which puts no gaps between members, are rows.
TEST(Record, ColumnsStandInTheOrderOfTheMembers) {
  std::size_t before = 0;
  for (const Column& column : kSampleColumns) {
    const std::size_t place = place_of<SensorSample, kSampleBytes>(column);
    ASSERT_LT(place, sizeof(SensorSample)) << column.name;
    EXPECT_TRUE(place > before || column.offset == 0) << column.name;
    before = place;
  }
  before = 0;
  for (const Column& column : kOutputColumns) {
    const std::size_t place = place_of<RobotOutput, kOutputBytes>(column);
    ASSERT_LT(place, sizeof(RobotOutput)) << column.name;
    EXPECT_TRUE(place > before || column.offset == 0) << column.name;
    before = place;
  }
}

}  // namespace
}  // namespace screed
