// Parameters by names and units, and in files.
#include <gtest/gtest.h>

#include <functional>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "schema/class_values.h"
#include "tests/temp_folder.h"
#include "tools/screed/link/named_parameters.h"

namespace screed {
namespace {

// Parameters as people name and write them.

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

// Parameters in files: what a dump gives back, what load refuses, in which order it writes.

class ParameterFile : public ::testing::Test {
 protected:
  std::filesystem::path write(const std::string& text) const {
    std::filesystem::path file = folder_.path() / "file.ini";
    write_text(file, text);
    return file;
  }
  std::vector<ParameterValue> read(const std::string& text) const {
    return read_parameter_file(write(text));
  }
  std::string refusal(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  const TempFolder folder_;
};

/// Each at its greatest, where they fit together.
Parameters unusual() {
  Parameters parameters;
  for (const ParameterInfo& info : kParameterTable) parameters.values[info.number] = info.max;
  parameters.algorithm() = static_cast<int16_t>(message::LevelingAlgorithm::kSpinOnPeak);
  EXPECT_TRUE(parameters.valid());
  return parameters;
}

TEST_F(ParameterFile, ADumpGivesAllBack) {
  const std::string text = parameter_file_text(unusual(), "A title");
  EXPECT_EQ(text.rfind("# A title\n", 0), 0U);
  EXPECT_NE(text.find("climb_threshold = 4500  # 45 deg\n"), std::string::npos) << text;
  EXPECT_EQ(read(text), all_parameters(unusual()));
  EXPECT_EQ(read(parameter_file_text({}, "")), all_parameters({}));
}

TEST_F(ParameterFile, ADumpIsAnExperiment) {
  const Experiment experiment = read_experiment(write(parameter_file_text(unusual(), "")));
  EXPECT_EQ(all_parameters(experiment.parameters), all_parameters(unusual()));
  EXPECT_EQ(experiment.experiment.algorithm, "spin_on_peak");
  EXPECT_TRUE(experiment.notes.empty());
}

TEST_F(ParameterFile, TheTrainingDriveKeepsItsLength) {
  Parameters parameters;
  parameters.algorithm() = static_cast<int16_t>(message::LevelingAlgorithm::kTrainingDrive);
  parameters.training_block() = 321;
  EXPECT_EQ(read(parameter_file_text(parameters, "")), all_parameters(parameters));
  const auto values = read("[experiment]\nalgorithm = training_drive\nframes = 800\n");
  ASSERT_EQ(values.size(), 2U);
  EXPECT_EQ(values[1], (ParameterValue{parameter_index("training_block"), 100}));
}

TEST_F(ParameterFile, OnlyWhatIsNamedIsTaken) {
  const auto values = read("[map]\nfilename = x.png\n[parameters]\nclimb_speed = 150\n");
  EXPECT_EQ(values, (std::vector<ParameterValue>{{parameter_index("climb_speed"), 150}}));
}

TEST_F(ParameterFile, AMistakeIsNamedWithFileLineAndKey) {
  const std::string begin = (folder_.path() / "file.ini").string() + ":3: ";
  EXPECT_EQ(refusal("[parameters]\nclimb_speed = 150\nclimb_sped = 2\n").rfind(begin, 0), 0U);
  const std::string range = refusal("[parameters]\nclimb_speed = 150\ntilt_limit = 1\n");
  EXPECT_EQ(range.rfind(begin + "[parameters] tilt_limit = '1'", 0), 0U) << range;
  EXPECT_NE(refusal("[map]\nfilename = x.png\n").find("names no parameter"), std::string::npos);
  EXPECT_NE(refusal("[parameters]\nwalk_leg_min = 9000\nwalk_leg_max = 8000\n")
                .find("is above [parameters] walk_leg_max"),
            std::string::npos);
}

TEST(WritingOrder, LeavesOutWhatIsThereAlready) {
  const Parameters now;
  const uint16_t speed = parameter_index("climb_speed");
  EXPECT_TRUE(writing_order(now, all_parameters(now)).empty());
  EXPECT_EQ(writing_order(now, {{speed, 150}}), (std::vector<ParameterValue>{{speed, 150}}));
}

TEST(WritingOrder, KeepsTheRobotsParametersValidAllTheTime) {
  const uint16_t least = parameter_index("walk_speed_min");
  const uint16_t greatest = parameter_index("walk_speed_max");
  Parameters now;  // 60 to 160
  const std::vector<ParameterValue> up = {{least, 200}, {greatest, 240}};
  EXPECT_EQ(writing_order(now, up), (std::vector<ParameterValue>{up[1], up[0]}));
  const std::vector<ParameterValue> down = {{greatest, 40}, {least, 20}};
  EXPECT_EQ(writing_order(now, down), (std::vector<ParameterValue>{down[1], down[0]}));
  try {
    writing_order(now, {{least, 200}});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("walk_speed_min"), std::string::npos);
  }
}

}  // namespace
}  // namespace screed
