// Schedules of a wheel's motion, and what the testbed makes of them.
#include "host_sim/soil_validation/wheel_schedule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/soil_validation/wheel_testbed.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

std::string file_with(const TempFolder& folder, const std::string& text) {
  const std::filesystem::path file = folder.path() / "schedule.csv";
  write_text(file, text);
  return file.string();
}

TEST(WheelScheduleTest, IsLinearBetweenMomentsAndStaysBehindTheLast) {
  const TempFolder folder;
  const WheelSchedule schedule = read_wheel_schedule(
      file_with(folder, "time_s,rim_m_s,travel_m_s,slip_angle_deg\n0,0.1,0.2,0\n2,0.3,0.2,90\n"));
  EXPECT_DOUBLE_EQ(schedule.duration_s(), 2.0);
  EXPECT_NEAR(schedule.at(1.0).rim, 0.2, 1e-12);
  EXPECT_NEAR(schedule.at(1.0).left, 0.1, 1e-12);
  EXPECT_NEAR(schedule.at(9.0).left, 0.2, 1e-12);
  EXPECT_NEAR(schedule.at(9.0).ahead, 0.0, 1e-12);
}

TEST(WheelScheduleTest, AStepOfSlipEndsAtItsRimWithItsTimeConstant) {
  const WheelSchedule schedule = step_of_slip(0.01, 60.0 * kDegree, 0.1, 0.13, 5.0);
  const WheelMotion first = schedule.at(0.0);
  EXPECT_NEAR(first.rim, 0.005, 1e-12) << "it rolls without slip ahead";
  EXPECT_NEAR(first.left, 0.01 * std::sqrt(0.75), 1e-12);
  EXPECT_NEAR(schedule.at(0.13).rim, 0.1 - 0.095 * std::exp(-1.0), 0.01 * 0.095);
  EXPECT_DOUBLE_EQ(schedule.at(5.0).rim, 0.1);
}

TEST(WheelScheduleTest, SaysWhatIsWrongAndWhere) {
  const TempFolder folder;
  struct Wrong {
    const char* text;
    const char* message;
  };
  for (const Wrong& wrong :
       {Wrong{"time_s,rim_m_s,travel_m_s\n", "schedule.csv"},
        Wrong{"time_s,rim_m_s\n0,0.1\n", "travel_m_s"},
        Wrong{"time_s,rim_m_s,travel_m_s\n0,0.1,0.1\n0,0.1,0.1\n", "schedule.csv:3"},
        Wrong{"time_s,rim_m_s,travel_m_s\n0,11,0.1\n", "schedule.csv:2"}}) {
    try {
      read_wheel_schedule(file_with(folder, wrong.text));
      FAIL() << wrong.text;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(wrong.message), std::string::npos) << error.what();
    }
  }
}

// A wheel that goes on as it began is that of a steady pass; a belt of the same load sinks less,
// and lugs dig it in.
TEST(WheelScheduleTest, AWheelOnAScheduleIsThatOfAPassAndABeltSinksLess) {
  WheelTest test;
  test.soil = soil_preset("cmu_2022");
  test.wheel.slip = 0.5;
  test.mass_kg = 0.3;
  const WheelPass pass = run_wheel(test).passes[0];
  const WheelSchedule steady({{0.0, {0.05, 0.0, 0.1}}, {3.0, {0.05, 0.0, 0.1}}});
  const auto last = [&] { return run_wheel(test, steady, 0.1).samples.back(); };
  const WheelSample wheel = last();
  EXPECT_NEAR(wheel.sinkage_m / pass.sinkage_m, 1.0, 0.02);
  EXPECT_NEAR(wheel.drawbar_pull_n, pass.drawbar_pull_n, 0.02 * test.wheel.load_n);
  EXPECT_NEAR(wheel.travel_m, 0.15, 1e-3);
  EXPECT_NEAR(wheel.slip_path_m, 0.15, 1e-3);
  test.belt_m = 0.1;
  const double belt = last().sinkage_m;
  EXPECT_LT(belt, 0.8 * wheel.sinkage_m);
  test.lug_height_m = 0.002;
  EXPECT_GT(last().sinkage_m, belt + 0.5e-3);
}

}  // namespace
}  // namespace screed
