// `screed session compare` and `screed session odometry`, as a user meets them.
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
#include "host_sim/run/session/session_writer.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

// `screed session compare` as a user meets it.

class SessionCompare : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("e.ini",
          "[experiment]\nduration = 2\nalgorithm = hill_sensing\nseed = 1\n[map]\nsize = 1\n"
          "model = scm\n[soil]\ncell = 0.02\n");
    record("one", "");
  }
  void record(const std::string& name, const std::string& options) const {
    const Result result = run("sim e.ini --quiet --no-pictures --out " + name + " " + options);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  Json compare(const std::string& arguments) const {
    const Result result = run("session compare " + arguments + " --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse_or_null(result.out);
  }
  bool exists(const char* name) const { return std::filesystem::exists(root_ / name); }
};

TEST_F(SessionCompare, TheSameRunTwiceIsIdentical) {
  record("again", "");
  const Result result = run("session compare one again/session.h5 --fail-if-different");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.substr(0, 10), "identical\n");
  EXPECT_EQ(read(root_ / "compare.png").substr(1, 3), "PNG");
  const Json json = compare("one again --no-picture");
  EXPECT_EQ(json["identical"], true);
  EXPECT_TRUE(json["first_difference"].is_null());
  EXPECT_TRUE(json["picture"].is_null());
}

TEST_F(SessionCompare, AnotherSeedDiffersFromItsFirstTick) {
  record("seed", "--seed 2");
  const Json json = compare("one seed --out p.png");
  EXPECT_EQ(json["identical"], false);
  EXPECT_EQ(json["configuration"][0]["key"], "experiment.seed");
  EXPECT_EQ(json["configuration"][0]["a"], "1");
  EXPECT_EQ(json["configuration"][0]["b"], "2");
  EXPECT_LT(json["first_difference"]["tick"], 10);
  EXPECT_EQ(json["a"]["end"]["time_s"], json["b"]["end"]["time_s"]);
  EXPECT_GE(json["deviation"]["largest_position"]["position_m"],
            json["deviation"]["last"]["position_m"]);
  EXPECT_TRUE(exists("p.png"));
  const Result text = run("session compare one seed --no-picture");
  EXPECT_EQ(text.exit_code, 0) << "different, as diff would say with 1";
  EXPECT_NE(text.out.find("first difference in tick "), std::string::npos) << text.out;
  EXPECT_EQ(run("session compare one seed --no-picture --fail-if-different").exit_code, 1);
  EXPECT_FALSE(exists("compare.png"));
}

TEST_F(SessionCompare, AShorterRunIsTheBeginningOfALongerOne) {
  record("short", "--duration 1");
  const Json json = compare("one short --no-picture");
  EXPECT_TRUE(json["first_difference"].is_null()) << json["first_difference"];
  EXPECT_EQ(json["common_ticks"], 100);
  EXPECT_EQ(json["identical"], false);
  EXPECT_NE(run("session compare one short --no-picture").out.find("A has 200 ticks, B 100"),
            std::string::npos);
}

TEST_F(SessionCompare, AnotherGridIsSaidAndDrawnWithoutADifferenceOfTerrain) {
  record("coarse", "--set soil.cell=0.025");
  const Json json = compare("one coarse");
  const std::string why = json["terrain"]["not_compared"].text();
  EXPECT_NE(why.find("0.02 m"), std::string::npos) << why;
  EXPECT_NE(why.find("0.025 m"), std::string::npos) << why;
  EXPECT_TRUE(exists("compare.png"));
}

TEST_F(SessionCompare, WithoutACommonTickNoneIsEqual) {
  // As a run that is killed within its first block of ticks leaves its session.
  {
    SessionWriter writer(root_ / "killed.h5", SessionReader(root_ / "one" / "session.h5").info());
    writer.finish();
  }
  const Result result = run("session compare one killed.h5");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("ticks          none that both have\n"), std::string::npos)
      << result.out;
  EXPECT_EQ(result.out.find("equal"), std::string::npos) << result.out;
}

TEST_F(SessionCompare, RefusesInOneLineAndLeavesNothing) {
  write("half.h5", read(root_ / "one" / "session.h5").substr(0, 20000));
  const auto refused = [this](const std::string& arguments, int code,
                              const std::vector<std::string>& parts) {
    expect_refused(run("session compare " + arguments), code, parts);
  };
  refused("one nowhere", 2, {"nowhere", "no such file"});
  refused("nowhere one", 2, {"nowhere", "no such file"});
  refused("one e.ini", 2, {"e.ini"});
  refused("one half.h5", 2, {"half.h5"});
  refused("one", 2, {"B is required"});
  refused("one one --out p.svg", 2, {"p.svg", ".png"});
  refused("one one --no-picture --out p.png", 2, {"--no-picture", "--out"});
  refused("one one --out no_folder/p.png", 1, {"no_folder/p.png"});
  EXPECT_FALSE(exists("compare.png"));
}

// `screed session odometry`: its legs against the recorded columns of a run, and bad input.

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
