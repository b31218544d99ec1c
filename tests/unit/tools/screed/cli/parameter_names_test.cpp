// Parameters as people name and write them.
#include "tools/screed/cli/parameter_names.h"

#include <gtest/gtest.h>

#include <functional>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"

namespace screed {
namespace {

int16_t value_of(const std::string& name, const std::string& text) {
  return parameter_value(parameter_index(name), text);
}
std::string text_of(const std::string& name, int32_t value) {
  return parameter_text(parameter_index(name), value);
}
std::string refusal(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}
std::string refusal_of(const std::string& name, const std::string& text) {
  return refusal([&] { value_of(name, text); });
}

TEST(ParameterNames, ScaledUnitsAreShownAsPeopleReadThem) {
  EXPECT_EQ(text_of("climb_threshold", 500), "5 deg");
  EXPECT_EQ(text_of("climb_threshold", 512), "5.12 deg");
  EXPECT_EQ(text_of("gyro_offset_x", 3), "0.21 deg/s");
  EXPECT_EQ(text_of("gyro_offset_x", -1), "-0.07 deg/s");
  EXPECT_EQ(text_of("accel_offset_y", 2), "0.488 mg");
  EXPECT_EQ(text_of("speed_kp", 24), "1.5 duty per mm/s");
  EXPECT_EQ(text_of("yaw_kp", 64), "0.25");
  EXPECT_EQ(text_of("yaw_ki", 768), "3 per s");
  EXPECT_EQ(text_of("climb_speed", 200), "200 mm/s");
  EXPECT_EQ(text_of("random_seed", 7), "7");
}

TEST(ParameterNames, ValuesWithNamesHaveThem) {
  EXPECT_EQ(text_of("algorithm", 2), "spin_on_peak");
  EXPECT_EQ(value_of("algorithm", "spin_on_peak"), 2);
  EXPECT_EQ(value_of("algorithm", "1"), 1);
  EXPECT_EQ(text_of("algorithm", 77), "77");
  EXPECT_NE(refusal_of("algorithm", "fly").find("hill_sensing, spin_on_peak"), std::string::npos);
}

TEST(ParameterNames, EveryValueComesBackFromItsText) {
  uint16_t index = 0;
  for (const ParameterInfo& info : kParameterTable) {
    for (const int16_t value : {info.min, info.default_value, info.max,
                                static_cast<int16_t>((info.min + info.max) / 2)}) {
      const std::string text = parameter_text(index, value);
      EXPECT_EQ(parameter_value(index, text), value) << info.name << " " << text;
    }
    ++index;
  }
}

TEST(ParameterNames, TakesNumbersWithAndWithoutTheUnit) {
  EXPECT_EQ(value_of("climb_threshold", "7.5"), 750);
  EXPECT_EQ(value_of("climb_threshold", "7.5deg"), 750);
  EXPECT_EQ(value_of("climb_threshold", "7.5  deg"), 750);
  EXPECT_EQ(value_of("battery_low", "6600"), 6600);
  EXPECT_EQ(value_of("battery_low", "6.6 V"), 6600);
  EXPECT_EQ(value_of("climb_speed", "0.15 m/s"), 150);
  EXPECT_EQ(value_of("spin_time", "4 s"), 4000);
  EXPECT_EQ(value_of("gyro_offset_x", "0.1 deg/s"), 1);  // the nearest step
  EXPECT_EQ(value_of("accel_offset_x", "-0.1 g"), -410);
}

TEST(ParameterNames, RefusesWhatIsNoValueAndSaysWhatIsAllowed) {
  EXPECT_EQ(refusal_of("climb_threshold", "500"),
            "climb_threshold = '500' is not allowed; allowed are 1 to 45 deg");
  EXPECT_EQ(refusal_of("climb_speed", "19"),
            "climb_speed = '19' is not allowed; allowed are whole numbers 20 to 250 mm/s");
  for (const char* text : {"", "nan", "inf", "deg", "5 rad", "5 deg deg", "5 5", "1e1", "0x5",
                           "99999999999999999999", "-5", "5 Deg"})
    EXPECT_NE(refusal_of("climb_threshold", text), "") << text;
  EXPECT_NE(refusal_of("climb_speed", "150.5"), "");
  EXPECT_NE(refusal_of("climb_speed", "150 mm"), "");
  EXPECT_NE(refusal([] { checked_parameter(parameter_index("climb_speed"), 251); }), "");
}

TEST(ParameterNames, ThatAreUnknownAreAnsweredWithTheNearest) {
  EXPECT_EQ(
      refusal([] { parameter_index("clim_speed"); }),
      "unknown parameter 'clim_speed'; did you mean climb_speed? screed param list shows all");
  EXPECT_EQ(refusal([] { parameter_index("zzz"); }),
            "unknown parameter 'zzz'; screed param list shows all");
}

TEST(ParameterNames, NoUnitThatIsShownIsScaled) {
  uint16_t index = 0;
  for (const ParameterInfo& info : kParameterTable) {
    const std::string unit = parameter_unit(index++);
    EXPECT_TRUE(unit.empty() || (unit[0] >= 'a' && unit[0] <= 'z')) << info.name << " " << unit;
  }
}

}  // namespace
}  // namespace screed
