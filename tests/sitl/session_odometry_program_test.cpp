// `screed session odometry`: its legs against the recorded columns of a run, and bad input.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "firmware/robot/supervisor.h"
#include "host_sim/core/json.h"
#include "host_sim/run/comparison/odometry_errors.h"
#include "host_sim/run/session/session_reader.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class SessionOdometry : public Program {};

TEST_F(SessionOdometry, TheFirstLegIsTheFirmwaresOwnPosition) {
  // Legs use no fixes, the recorded column would.
  const Result run_result =
      run("sim first_drive --set fixes.period=0 --duration 60 --quiet --no-pictures --out run");
  ASSERT_EQ(run_result.exit_code, 0) << run_result.err;
  const std::filesystem::path file = root_ / "run/session.h5";
  const std::vector<OdometryLeg> legs = odometry_legs(file, 1.5);
  ASSERT_GE(legs.size(), 2U);

  // Dead reckoning begins at the origin with the run, where the robot stands.
  const SessionReader session(file);
  std::vector<SimFrame> frames(session.frames());
  session.read(0, std::span(frames));
  const OdometryLeg& leg = legs.front();
  const SimFrame* start = nullptr;
  const SimFrame* end = nullptr;
  double path_m = 0.0;
  for (const SimFrame& frame : frames) {
    if (frame.time == leg.start_s) start = &frame;
    if (start == nullptr || &frame == start) continue;
    path_m += std::hypot(frame.delta_x, frame.delta_y);
    if (path_m < 1.5) continue;
    end = &frame;
    break;
  }
  ASSERT_NE(start, nullptr);
  ASSERT_NE(end, nullptr);
  EXPECT_EQ(start->state, static_cast<int>(RobotState::kRunning));
  EXPECT_NEAR(leg.duration_s, end->time - start->time, 1e-9);
  const double expected =
      std::hypot(end->odometry_x - (end->x - start->x), end->odometry_y - (end->y - start->y));
  EXPECT_NEAR(leg.error_m[0], expected, 0.003) << "to the millimetre and the tick";
  // On rigid ground the tracks hardly slip.
  EXPECT_NEAR(leg.travelled_m, 1.5, 0.3);
  EXPECT_LT(leg.error_m[0], 0.3);
}

TEST_F(SessionOdometry, PrintsJsonAndRefusesWhatItCannotJudge) {
  ASSERT_EQ(run("sim first_drive --duration 15 --quiet --no-pictures --out run").exit_code, 0);
  const Result result = run("session odometry run run/session.h5 --length 0.4 --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = Json::parse(result.out);
  EXPECT_EQ(json["legs"].get<int>() % 2, 0) << "twice the same run";
  EXPECT_GT(json["legs"].get<int>(), 0);
  EXPECT_EQ(json["errors"].size(), 3U);
  EXPECT_LT(json["consistent_95"][0].get<double>(), 1.0);
  EXPECT_GT(json["consistent_95"][1].get<double>(), 1.0);

  const Result too_long = run("session odometry run --length 1000");
  EXPECT_NE(too_long.exit_code, 0);
  EXPECT_NE(too_long.err.find("--length"), std::string::npos) << too_long.err;
  EXPECT_NE(run("session odometry nowhere").exit_code, 0);
}

}  // namespace
}  // namespace screed::testing
