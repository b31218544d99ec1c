// The parameter table: defaults, ranges, and the two faces of it.
#include "firmware/parameters/parameters.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "firmware/parameters/algorithms_in_build.h"
#include "firmware/parameters/parameter_table.h"

namespace screed {
namespace {

TEST(Parameters, DefaultsAreValidAndThoseOfTheTable) {
  const Parameters parameters;
  EXPECT_TRUE(parameters.valid());
  for (const ParameterInfo& info : kParameterTable)
    EXPECT_EQ(parameters.values[info.number], info.default_value) << info.name;
}

TEST(Parameters, EachIsCheckedAtBothEnds) {
  for (const ParameterInfo& info : kParameterTable) {
    Parameters parameters;
    // Pairs that must be ordered get room.
    parameters.walk_speed_min() = 0;
    parameters.walk_speed_max() = 250;
    parameters.walk_leg_min() = 100;
    parameters.walk_leg_max() = 20000;
    const std::string name = info.name;
    for (const int end : {info.min, info.max}) {
      if (name == "walk_speed_max") parameters.walk_speed_min() = 0;
      parameters.values[info.number] = static_cast<int16_t>(end);
      EXPECT_TRUE(parameters.valid()) << name << " = " << end;
    }
    if (info.max < INT16_MAX) {
      parameters.values[info.number] = static_cast<int16_t>(info.max + 1);
      EXPECT_FALSE(parameters.valid()) << name;
    }
    parameters.values[info.number] = static_cast<int16_t>(info.min - 1);
    EXPECT_FALSE(parameters.valid()) << name;
  }
}

TEST(Parameters, EveryAlgorithmOfTheBuildIsAllowedAndNoOther) {
  for (int number = -1; number <= 16; ++number) {
    Parameters parameters;
    parameters.algorithm() = static_cast<int16_t>(number);
    const bool there_is = number >= 0 && number <= message::kLevelingAlgorithmMax &&
                          algorithm_in_build(static_cast<int16_t>(number));
    EXPECT_EQ(parameters.valid(), there_is) << number;
  }
}

TEST(Parameters, OrderedPairs) {
  Parameters speeds;
  speeds.walk_speed_min() = static_cast<int16_t>(speeds.walk_speed_max() + 1);
  EXPECT_FALSE(speeds.valid());
  speeds.walk_speed_min() = speeds.walk_speed_max();
  EXPECT_TRUE(speeds.valid()) << "legs of one speed";
  Parameters legs;
  legs.walk_leg_min() = static_cast<int16_t>(legs.walk_leg_max() + 1);
  EXPECT_FALSE(legs.valid());
  legs.walk_leg_min() = legs.walk_leg_max();
  EXPECT_TRUE(legs.valid()) << "legs of one length";
}

TEST(Parameters, TheTableNamesEachOnceInTheirOrder) {
  std::set<std::string> names;
  uint8_t number = 0;
  for (const ParameterInfo& info : kParameterTable) {
    names.insert(info.name);
    EXPECT_EQ(info.number, number++);
    EXPECT_LT(info.min, info.max);
    EXPECT_NE(std::string(info.meaning), "");
  }
  EXPECT_EQ(names.size(), std::size(kParameterTable));
  EXPECT_EQ(number, Parameters::kCount);
}

TEST(Parameters, AsUnsafeOnesAreOffByDefault) {
  const Parameters parameters;
  EXPECT_EQ(parameters.standalone(), 0);
  EXPECT_GT(parameters.battery_low(), 0);
}

}  // namespace
}  // namespace screed
