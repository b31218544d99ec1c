// What a person does beside a robot: drives it by keys, sends it position fixes, and has several
// programs at its port at a time.
// Long: a simulated robot answers over a port in real time.
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/robot/supervisor.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/run/session/session_reader.h"
#include "tests/long/robot_at_port.h"
#include "tests/sitl/background.h"
#include "tests/sitl/terminal.h"

namespace screed::testing {
namespace {

class GroundTools : public RobotAtPort {
 protected:
  std::vector<SimFrame> frames() const {
    const SessionReader session(root_ / "robot/session.h5");
    std::vector<SimFrame> frames(session.frames());
    session.read(0, std::span(frames));
    return frames;
  }
  /// By the robot, in the log that the program writes.
  std::optional<double> said_last(const char* signal) const {
    std::optional<double> value;
    try {
      read_robot_log(root_ / "drive.log",
                     [&](const RobotLogFrame& it) { value = it.robot.value(signal); });
    } catch (const InputError&) {
      // It has heard nothing yet.
    }
    return value;
  }
};

TEST_F(GroundTools, APersonDrivesByKeysAndTheRobotStandsWhenTheKeyIsLetGo) {
  write("flat.ini",
        "[experiment]\nname = flat\nalgorithm = hill_sensing\nduration = 600\n"
        "[map]\nsize = 20\n");
  Background robot(
      program_, {"sim", "flat.ini", "--pty", "radio", "--out", "robot", "--quiet", "--no-pictures"},
      root_, log("sim"));
  ASSERT_TRUE(wait_until(robot, [&] { return std::filesystem::exists(root_ / "radio"); }));
  Terminal person({program_, "drive", "--pty", "radio", "--log", "drive.log"}, root_);
  const auto says = [&](const char* signal) { return said_last(signal).value_or(0.0); };
  // It takes the robot over meanwhile.
  ASSERT_TRUE(person.hold_until("\x1bOA", [&] { return says("odometry.x") > 100.0; }));
  ASSERT_TRUE(person.hold_until("", [&] { return says("leveling.speed") == 0.0; }));
  ASSERT_TRUE(person.hold_until("j", [&] { return says("odometry.heading") > 10.0; }));
  ASSERT_TRUE(person.hold_until("", [&] { return says("leveling.turn_rate") == 0.0; }));
  person.type("q");
  EXPECT_EQ(person.exit_code(), 0) << person.screen();
  EXPECT_EQ(run("param get --pty radio algorithm").out, "algorithm = hill_sensing\n");
  robot.signal(SIGINT);
  robot.wait();

  const std::vector<SimFrame> frames = this->frames();
  double fastest = 0.0;
  double turn = 0.0;
  double last_order = 1.0;
  for (const SimFrame& frame : frames) {
    if (frame.leveling_state != static_cast<int>(message::LevelingState::kDrive)) continue;
    fastest = std::max(fastest, frame.linear);
    turn = std::max(turn, frame.angular);
    last_order = frame.linear;
  }
  EXPECT_NEAR(fastest, 0.15, 1e-3);
  EXPECT_NEAR(turn, 45.0 * M_PI / 180.0, 0.01);
  EXPECT_EQ(last_order, 0.0);
  EXPECT_EQ(frames.back().state, static_cast<int>(RobotState::kDisarmed));
  EXPECT_GT(std::hypot(frames.back().x, frames.back().y), 0.02);
  // The log is a log.
  const Result summary = run("log summary drive.log --json");
  ASSERT_EQ(summary.exit_code, 0) << summary.err;
  EXPECT_EQ(Json::parse(summary.out)["robots"][0]["robot"], "robot 1");
}

TEST_F(GroundTools, DrivingNeedsATerminal) {
  expect_refused(run("drive --pty nowhere"), 2, {"terminal"});
}

TEST_F(GroundTools, FixesReachTheRobot) {
  const Result result = with_robot(
      "printf '# x y sigma\\n0.75 -0.5\\n\\n9 9 0.5\\n0.75 -0.5 0.02\\n0.75 -0.5\\n' > fixes\n"
      "$screed fix --pty radio fixes || exit 98\n"
      "$screed monitor --pty radio --once\n",
      "--set fixes.period=0");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("3 fixes taken by robot 1, 0 without an answer, 1 too uncertain"),
            std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("odometry: x 7"), std::string::npos) << result.out;
  const SimFrame last = frames().back();
  EXPECT_NEAR(last.odometry_x, 0.75, 0.01);
  EXPECT_NEAR(last.odometry_y, -0.5, 0.01);
}

TEST_F(GroundTools, FixesComeByUdpAsWellAndTheNewestCounts) {
  const Result result = with_robot(
      "$screed fix --pty radio --udp 45991 > said.txt & fix=$!\n"
      "until $screed monitor --pty radio --plain --once | grep -q 'odometry: x 1'; do\n"
      "  printf '1.25 0.5\\n' > /dev/udp/127.0.0.1/45991\n"
      "done\n"
      "kill -INT $fix; wait $fix; [ $? = 130 ]\n",
      "--set fixes.period=0");
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NEAR(frames().back().odometry_x, 1.25, 0.03);
}

TEST_F(GroundTools, AWrongFixIsNamedByItsLine) {
  for (const auto& [line, words] : std::vector<std::pair<std::string, std::string>>{
           {"0.5", "1 numbers; allowed: x y or x y sigma, in metres"},
           {"a b", "'a' is no number"},
           {"30 0", "beyond -20.47 to 20.47 m"},
           {"1 1 -1", "a negative standard deviation"}}) {
    write("fixes", "# a comment\n" + line + "\n");
    const Result result = with_robot("$screed fix --pty radio fixes\n", "--set fixes.period=0");
    EXPECT_EQ(result.exit_code, 2) << line;
    EXPECT_NE(result.err.find("fixes, line 2: "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
    std::filesystem::remove_all(root_ / "robot");
    std::filesystem::remove(root_ / "said");
  }
}

// Each signs with the next number: none spoils another's.
TEST_F(GroundTools, FixesAndCommandsGoBesideEachOther) {
  const Result result = with_robot(
      "$screed monitor --pty radio --plain > seen.txt & monitor=$!\n"
      "for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do echo 0.5 0.5; done > fixes\n"
      "$screed fix --pty radio fixes & fix=$!\n"
      "for i in 1 2 3 4 5 6; do\n"
      "  $screed param get --pty radio climb_threshold > got.txt || exit 90\n"
      "done\n"
      "wait $fix || exit 91\n"
      "kill -INT $monitor; wait $monitor\n",
      "--set fixes.period=0");
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("20 fixes taken by robot 1, 0 without an answer"), std::string::npos)
      << result.out;
}

// One holds the port, the others are its guests; the one is the ground station, and what it keeps
// alive the others may command.
TEST_F(GroundTools, SeveralProgramsShareThePort) {
  const Result result = with_robot(
      "$screed monitor --pty radio --plain > seen.txt & monitor=$!\n"
      "$screed param set --pty radio algorithm drive || exit 90\n"
      "until $screed send --pty radio arm > armed.txt; do :; done\n"
      "$screed send --pty radio run || exit 91\n"
      "$screed send --pty radio drive 0.1 0 || exit 92\n"
      "until grep -q 'odometry: x -*1[0-9][0-9] ' seen.txt; do :; done\n"
      "$screed send --pty radio stop || exit 93\n"
      "kill -INT $monitor; wait $monitor\n");
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_NE(result.out.find("drive: done"), std::string::npos) << result.out;
  double fastest = 0.0;
  for (const SimFrame& frame : frames()) fastest = std::max(fastest, frame.linear);
  EXPECT_NEAR(fastest, 0.1, 1e-3);
}

}  // namespace
}  // namespace screed::testing
