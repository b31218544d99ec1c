// A robot's telemetry log, shown as a run is: against the recording of the run that it came from.
#include <cmath>
#include <cstdlib>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "firmware/robot/supervisor.h"
#include "host_sim/core/json.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/scene/log_session.h"
#include "host_sim/run/session/session_reader.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

std::vector<SimFrame> frames_of(const std::filesystem::path& file) {
  const SessionReader session(file);
  std::vector<SimFrame> frames(session.frames());
  session.read(0, std::span(frames));
  return frames;
}

class Log : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    ASSERT_EQ(
        run("sim first_drive --set fixes.period=0 --duration 40 --quiet --no-pictures --out r")
            .exit_code,
        0);
    truth_ = frames_of(root_ / "r/session.h5");
  }
  std::vector<SimFrame> truth_;
};

// What comes by radio is some hundredths of a second old, and place comes five times a second.
TEST_F(Log, BecomesASessionOfWhatTheRobotKnew) {
  std::filesystem::create_directories(root_ / "made");
  write_log_sessions(root_ / "r/telemetry.log", root_ / "made", kDefaultBoard);
  const SessionReader made(root_ / "made/session.h5");
  EXPECT_EQ(made.info().tick_rate_hz, 20U);
  const std::vector<SimFrame> rows = frames_of(root_ / "made/session.h5");
  ASSERT_NEAR(static_cast<double>(rows.size()), 40.0 * 20.0, 4.0);
  int states = 0;
  int activities = 0;
  for (size_t i = 40; i < rows.size(); ++i) {
    const SimFrame& row = rows[i];
    const SimFrame& then = truth_.at(static_cast<size_t>(std::lround(row.time * 100.0)));
    EXPECT_NEAR(row.x, then.odometry_x, 0.08) << row.time;
    EXPECT_NEAR(row.y, then.odometry_y, 0.08) << row.time;
    EXPECT_NEAR(row.pitch, then.est_pitch, 0.12) << row.time;
    EXPECT_NEAR(row.battery, then.battery, 0.3) << row.time;
    states += row.state == then.state;
    activities += row.leveling_state == then.leveling_state;
  }
  const auto count = static_cast<double>(rows.size() - 40);
  EXPECT_GT(states / count, 0.98);
  EXPECT_GT(activities / count, 0.95);
  EXPECT_TRUE(std::isnan(rows.back().energy)) << "the robot does not measure it";
  // In the mean there is no delay to speak of: the whole path is there.
  EXPECT_NEAR(rows.back().x, truth_.back().odometry_x, 0.03);
  EXPECT_NEAR(rows.back().y, truth_.back().odometry_y, 0.03);
}

TEST_F(Log, ItsSummaryIsThatOfTheRun) {
  const Result result = run("log summary r/telemetry.log --json");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto json = Json::parse(result.out);
  ASSERT_EQ(json["robots"].size(), 1U);
  const Json& robot = json["robots"][0];
  std::map<int, double> seconds;
  double path_m = 0.0;
  for (size_t i = 1; i < truth_.size(); ++i) {
    seconds[truth_[i].state] += 0.01;
    path_m += std::hypot(truth_[i].odometry_x - truth_[i - 1].odometry_x,
                         truth_[i].odometry_y - truth_[i - 1].odometry_y);
  }
  EXPECT_NEAR(robot["duration_s"].get<double>(), 40.0, 0.3);
  EXPECT_EQ(robot["algorithm"], "hill sensing");
  EXPECT_NEAR(robot["states_s"]["running"].get<double>(),
              seconds[static_cast<int>(RobotState::kRunning)], 0.5);
  EXPECT_NEAR(robot["path_m"].get<double>(), path_m, 0.1 * path_m);
  EXPECT_NEAR(robot["end_m"][0].get<double>(), truth_.back().odometry_x, 0.03);
  EXPECT_NEAR(robot["battery_v"]["last"].get<double>(), truth_.back().battery, 0.2);
  EXPECT_EQ(robot["link"]["lost"], 0);
  bool began = false;
  for (const Json& event : robot["events"]) began |= event["text"] == "state: running";
  EXPECT_TRUE(began);
  const Result words = run("log summary r/telemetry.log");
  EXPECT_NE(words.out.find("hill sensing"), std::string::npos) << words.out;
  EXPECT_NE(words.out.find("state: running"), std::string::npos) << words.out;
}

TEST_F(Log, IsReportedAndViewedAsARunIs) {
  std::filesystem::create_directories(root_ / "tmp");
  ASSERT_EQ(run("report r/telemetry.log --quiet", "TMPDIR=tmp").exit_code, 0);
  EXPECT_NE(read(root_ / "r/telemetry.html").find("</html>"), std::string::npos);
  ASSERT_EQ(run("view r/telemetry.log --screenshot seen.png --at 20", "TMPDIR=tmp").exit_code, 0);
  EXPECT_GT(std::filesystem::file_size(root_ / "seen.png"), 10'000U);
  EXPECT_TRUE(std::filesystem::is_empty(root_ / "tmp")) << "nothing stays behind";
}

TEST_F(Log, WhatIsNoLogIsRefusedInOneLine) {
  write("notes.txt", "a robot drove here\n");
  for (const char* command : {"log summary", "report", "view --screenshot a.png"}) {
    expect_refused(run(std::string(command) + " notes.txt"), 2,
                   {"notes.txt: holds no frame of a robot; 1 of 1 lines cannot be read"});
  }
  expect_refused(run("log summary nowhere.log"), 2, {"nowhere.log"});
  expect_refused(run("log summary r/telemetry.log --board toaster"), 2, {"toaster"});
}

}  // namespace
}  // namespace screed::testing
