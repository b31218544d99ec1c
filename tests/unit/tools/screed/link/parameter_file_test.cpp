// Parameters in files: what a dump gives back, what load refuses, in which order it writes.
#include "tools/screed/link/parameter_file.h"

#include <gtest/gtest.h>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "schema/class_values.h"
#include "tests/temp_folder.h"
#include "tools/screed/cli/parameter_names.h"

namespace screed {
namespace {

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
                .find("is above walk_leg_max"),
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
