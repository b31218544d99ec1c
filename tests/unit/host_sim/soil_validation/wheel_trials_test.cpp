// Which rows are trials of one test, and what mean and error they have.
#include "host_sim/soil_validation/wheel_trials.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "paths.h"
#include "tests/unit/host_sim/soil_validation/measured_row.h"

namespace screed {
namespace {

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
