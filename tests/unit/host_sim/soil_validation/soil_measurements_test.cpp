// Tables of measurements: what is read, and what is said about a table that is wrong.
#include "host_sim/soil_validation/soil_measurements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "host_sim/core/errors.h"
#include "paths.h"
#include "tests/temp_folder.h"
#include "tests/unit/host_sim/soil_validation/measured_row.h"

namespace screed {
namespace {

TEST(SoilMeasurementsTest, SayWhatIsWrongAndWhere) {
  const TempFolder folder;
  const std::string file = (folder.path() / "rows.csv").string();
  const auto message = [&](const std::string& text) {
    std::ofstream(file) << text;
    try {
      read_soil_measurements(file);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  const std::string head = "case,wheel_radius_m,wheel_width_m,load_n,slip,sinkage_m\n";
  EXPECT_EQ(message(head + "a,0.1,0.05,20,0.2,0.01\n"), "none");
  EXPECT_EQ(message(head + "a,0.1,0.05,20,1.2,0.01\n"),
            file + ":2: slip is '1.2', a number from -1 to 0.99 is needed");
  EXPECT_EQ(message(head + "a,0.1,0.05,20,0.2,0.01\nb,0.1,0.05,much,0,\n"),
            file + ":3: load_n is 'much', a number from 0.001 to 1e+06 is needed");
  EXPECT_EQ(message(head + "a,0.1,0.05\n"), file + ":2: no load_n");
  EXPECT_EQ(message(head), file + ": no case begins with ''");
  EXPECT_EQ(message("a,b\n1,2\n"),
            file + ":1: neither a column wheel_radius_m (wheels) nor plate_width_m (plates)");
  EXPECT_EQ(message(""), file + ": is empty");
  // As spreadsheets write it: a mark before UTF-8, blanks; and a comment.
  EXPECT_EQ(message("\xEF\xBB\xBF" + head + "a, 0.1, 0.05, 20, 0.2, 0.01\r\n"), "none");
  EXPECT_EQ(message("# of a test\n" + head + "a,0.1,0.05,20,1.2,0.01\n"),
            file + ":3: slip is '1.2', a number from -1 to 0.99 is needed");
  EXPECT_EQ(read_soil_measurements(std::string(kDataFolder) + "/soil/single_wheel_ding2011.csv",
                                   "ding2011_lug10")
                .wheels.size(),
            6U);
}

TEST(SoilMeasurementsTest, ErrorsAreColumnsThatMayBeThere) {
  const TempFolder folder;
  const std::string file = (folder.path() / "rows.csv").string();
  std::ofstream(file) << "case,wheel_radius_m,wheel_width_m,load_n,slip,drawbar_pull_n,"
                         "drawbar_pull_error_n,side_force_n,side_force_error_n,sinkage_m,"
                         "sinkage_error_m\n"
                         "a,0.1,0.05,20,0.2,3,0.5,2,0.25,0.01,0.001\n"
                         "b,0.1,0.05,20,0.2,3,,2,,0.01,\n";
  const std::vector<MeasuredWheel> wheels = read_soil_measurements(file).wheels;
  ASSERT_EQ(wheels.size(), 2U);
  EXPECT_EQ(wheels[0].drawbar_pull_error_n, 0.5);
  EXPECT_EQ(wheels[0].side_force_error_n, 0.25);
  EXPECT_EQ(wheels[0].sinkage_error_m, 0.001);
  EXPECT_EQ(wheels[1].drawbar_pull_error_n, std::nullopt);
  EXPECT_EQ(wheels[1].side_force_error_n, std::nullopt);
  EXPECT_EQ(wheels[1].sinkage_error_m, std::nullopt);
  // As readable as the figure that was digitised.
  const std::string ding = std::string(kDataFolder) + "/soil/single_wheel_ding2011.csv";
  for (const MeasuredWheel& wheel : read_soil_measurements(ding).wheels) {
    EXPECT_EQ(wheel.drawbar_pull_error_n, 0.5) << wheel.name;
    EXPECT_EQ(wheel.sinkage_error_m, 0.0005) << wheel.name;
  }
  std::ofstream(file) << "case,wheel_radius_m,wheel_width_m,load_n,slip,sinkage_error_m\n"
                         "a,0.1,0.05,20,0.2,-0.001\n";
  EXPECT_THROW(read_soil_measurements(file), InputError);
}

// ---- Which rows are trials of one test, and what mean and error they have

MeasuredWheel row(double slip, double slip_angle_rad, double load_n) {
  MeasuredWheel out = measured_row(slip, slip_angle_rad);
  out.wheel.load_n = load_n;
  return out;
}

using Rows = std::vector<std::size_t>;

TEST(WheelTrialsTest, RowsOfOneTestStandTogetherByAngleAndSlip) {
  std::vector<MeasuredWheel> rows = {row(0.5, 0.0, 24.0),    row(-0.2, 0.0, 24.0),
                                     row(0.501, 0.0, 21.0),  row(-0.2, -0.26, 24.0),
                                     row(-0.196, 0.0, 25.0), row(-0.194, 0.0, 25.0)};
  const std::vector<WheelTrials> tests = wheel_trials(rows);
  ASSERT_EQ(tests.size(), 4U);
  EXPECT_EQ(tests[0].rows, (Rows{3}));
  EXPECT_EQ(tests[0].slip_angle_rad, -0.26);
  EXPECT_EQ(tests[1].rows, (Rows{1, 4})) << "the third is 0.006 from the first";
  EXPECT_DOUBLE_EQ(tests[1].slip, -0.198);
  EXPECT_EQ(tests[2].rows, (Rows{5}));
  EXPECT_EQ(tests[3].rows, (Rows{0, 2}));
  EXPECT_DOUBLE_EQ(tests[3].slip, 0.5005);
}

TEST(WheelTrialsTest, OtherWheelsAndLoadsAreOtherTests) {
  std::vector<MeasuredWheel> rows(4, row(0.2, 0.0, 40.0));
  EXPECT_EQ(wheel_trials(rows).size(), 1U);
  rows[1].wheel.load_n = 80.0;
  EXPECT_EQ(wheel_trials(rows).size(), 2U);
  rows[2].wheel.radius_m *= 2.0;
  EXPECT_EQ(wheel_trials(rows).size(), 3U);
  rows[3].wheel.width_m *= 2.0;
  EXPECT_EQ(wheel_trials(rows).size(), 4U);
}

TEST(WheelTrialsTest, SeveralTrialsHaveTheirStandardDeviation) {
  std::vector<MeasuredWheel> rows(4, row(0.2, 0.0, 24.0));
  rows[0].drawbar_pull_n = 1.0;
  rows[1].drawbar_pull_n = 2.0;
  rows[3].drawbar_pull_n = 6.0;
  const WheelTrials all = wheel_trials(rows)[0];
  const auto pull = [&] {
    return mean_of_trials(rows, all, &MeasuredWheel::drawbar_pull_n,
                          &MeasuredWheel::drawbar_pull_error_n);
  };
  ASSERT_TRUE(pull());
  EXPECT_DOUBLE_EQ(pull()->value, 3.0);
  EXPECT_DOUBLE_EQ(pull()->error, std::sqrt((4.0 + 1.0 + 9.0) / 2.0));
  EXPECT_EQ(pull()->trials, 3U) << "one did not measure it";
  rows[1].drawbar_pull_error_n = 1.0;
  EXPECT_DOUBLE_EQ(pull()->error, std::sqrt(7.0)) << "what is stated is less";
  rows[1].drawbar_pull_error_n = 5.0;
  EXPECT_DOUBLE_EQ(pull()->error, 5.0);
  EXPECT_FALSE(mean_of_trials(rows, all, &MeasuredWheel::side_force_n));
}

TEST(WheelTrialsTest, ASingleTrialHasTheErrorThatItStates) {
  std::vector<MeasuredWheel> rows = {row(0.2, 0.0, 24.0)};
  rows[0].sinkage_m = 0.01;
  const WheelTrials one = wheel_trials(rows)[0];
  const auto error = [&] {
    return mean_of_trials(rows, one, &MeasuredWheel::sinkage_m, &MeasuredWheel::sinkage_error_m)
        ->error;
  };
  EXPECT_EQ(error(), 0.0);
  rows[0].sinkage_error_m = 0.0005;
  EXPECT_EQ(error(), 0.0005);
  EXPECT_EQ(mean_of_trials(rows, one, &MeasuredWheel::sinkage_m)->error, 0.0);
}

TEST(WheelTrialsTest, CmusTestsHaveThreeTrialsEach) {
  const auto rows =
      read_soil_measurements(std::string(kDataFolder) + "/soil/single_wheel_cmu2022.csv").wheels;
  const std::vector<WheelTrials> tests = wheel_trials(rows);
  ASSERT_EQ(tests.size(), 18U);
  for (const WheelTrials& test : tests) EXPECT_EQ(test.rows.size(), 3U) << test.slip;
  EXPECT_NEAR(tests[0].slip_angle_rad, -15.0 * std::numbers::pi / 180.0, 1e-12);
  const auto locked = mean_of_trials(rows, tests[9], &MeasuredWheel::drawbar_pull_n);
  ASSERT_TRUE(locked);
  // (-38.189 - 39.121 - 39.224) / 3, and the square root of half of 0.656^2 + 0.276^2 + 0.379^2.
  EXPECT_NEAR(locked->value, -38.845, 0.001);
  EXPECT_NEAR(locked->error, 0.570, 0.001);
}

}  // namespace
}  // namespace screed
