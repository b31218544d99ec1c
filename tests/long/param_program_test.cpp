// `screed param` and the remembered link as a user meets them: against a simulated robot on a
// virtual serial port, and against experiments.
// Long: a simulated robot answers over a port in real time.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "tests/long/robot_at_port.h"

namespace screed::testing {
namespace {

class ParamProgram : public RobotAtPort {
 protected:
  static size_t lines_in(const std::string& text) {
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
  }
};

TEST_F(ParamProgram, ReadsAndSetsByNameAndInWords) {
  const Result result = with_robot(
      "$screed param get --pty radio climb_threshold algorithm\n"
      "$screed param set --pty radio climb_threshold '7.5 deg'\n"
      "$screed param --pty radio set algorithm spin_on_peak\n"
      "$screed param get --pty radio climb_threshold algorithm --json\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string words =
      "climb_threshold = 5 deg\nalgorithm = hill_sensing\n"
      "climb_threshold = 7.5 deg: done\nalgorithm = spin_on_peak: done\n";
  ASSERT_EQ(result.out.substr(0, words.size()), words) << result.out;
  const auto json = Json::parse(result.out.substr(words.size()));
  EXPECT_EQ(json[0]["name"], "climb_threshold");
  EXPECT_EQ(json[0]["value"], 750);
  EXPECT_EQ(json[0]["text"], "7.5 deg");
  EXPECT_EQ(json[1]["text"], "spin_on_peak");
}

TEST_F(ParamProgram, LoadsWhatDiffersInAnOrderThatTheRobotTakes) {
  // 60 to 160 in the robot: the greatest must go first.
  write("fast.ini",
        "[parameters]\nwalk_speed_min = 200\nwalk_speed_max = 240\nclimb_speed = 200\n");
  const Result result = with_robot(
      "$screed param diff --pty radio fast.ini; echo \"exit $?\"\n"
      "$screed param load --pty radio fast.ini; echo \"exit $?\"\n"
      "$screed param diff --pty radio fast.ini; echo \"exit $?\"\n"
      "$screed param load --pty radio fast.ini; echo \"exit $?\"\n"
      "$screed param dump --pty radio --out dump.ini\n");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out,
            "walk_speed_min: 200 mm/s in fast.ini, 60 mm/s in the robot\n"
            "walk_speed_max: 240 mm/s in fast.ini, 160 mm/s in the robot\n"
            "exit 1\n"
            "walk_speed_max was 160 mm/s; walk_speed_max = 240 mm/s: done\n"
            "walk_speed_min was 60 mm/s; walk_speed_min = 200 mm/s: done\n"
            "3 in fast.ini, 2 differed, 2 set and read back\n"
            "exit 0\n"
            "exit 0\n"
            "the robot has all 3 of fast.ini already\n"
            "exit 0\n");
  EXPECT_EQ(result.err, "");
  // The dump is an experiment, and holds what was set.
  EXPECT_EQ(run("param diff fast.ini --experiment dump.ini").exit_code, 0);
  EXPECT_EQ(run("sim dump.ini --duration 1 --quiet --no-pictures --out drive").exit_code, 0);
  EXPECT_EQ(run("param diff dump.ini --experiment drive/experiment.ini").exit_code, 0);
}

TEST_F(ParamProgram, RefusesABadFileBeforeItLooksForARobot) {
  write("bad.ini", "[parameters]\nclimb_speed = 150\ntilt_limit = 1\n");
  expect_refused(run("param load --pty nowhere bad.ini"), 2, {"bad.ini:3: ", "tilt_limit"});
  expect_refused(run("param diff --pty nowhere bad.ini"), 2, {"bad.ini:3: "});
  expect_refused(run("param set --pty nowhere climb_speed 1000"), 2, {"20 to 250 mm/s"});
  expect_refused(run("param get --pty nowhere clim_speed"), 2, {"did you mean climb_speed?"});
  expect_refused(run("param load --pty nowhere first_drive"), 2, {"no such port"});
  expect_refused(run("send param get climb_speed"), 2, {"param"});
}

TEST_F(ParamProgram, ARobotThatRefusesEndsTheLoad) {
  write("slow.ini", "[parameters]\nclimb_speed = 150\nspin_rate = 60\n");
  // Armed, it takes live ones alone.
  const Result result = with_robot(
      "until $screed send --pty radio arm > /dev/null; do :; done\n"
      "$screed param load --pty radio slow.ini\n");
  EXPECT_EQ(result.exit_code, 1) << result.out << result.err;
  EXPECT_NE(result.out.find("climb_speed = 150 mm/s: done"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("spin_rate = 60 deg/s: refused: armed; disarm first"),
            std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("2 in slow.ini, 2 differed, 1 set"), std::string::npos) << result.out;
  EXPECT_NE(result.err.find("not all parameters were set"), std::string::npos) << result.err;
}

TEST_F(ParamProgram, ListAndDumpOfAnExperimentNeedNoRobot) {
  const Result list = run("param list");
  EXPECT_EQ(list.exit_code, 0);
  EXPECT_NE(list.out.find("1 to 45 deg; default: 5 deg; live\n"), std::string::npos) << list.out;
  EXPECT_EQ(Json::parse(run("param list --json").out).size(), lines_in(list.out) / 2);
  write("slow.ini", "[experiment]\nalgorithm = spin_on_peak\n[parameters]\nclimb_speed = 90\n");
  const Result dump = run("param dump --experiment slow.ini");
  EXPECT_EQ(dump.exit_code, 0);
  EXPECT_NE(dump.out.find("algorithm = spin_on_peak\n"), std::string::npos) << dump.out;
  EXPECT_NE(dump.out.find("climb_speed = 90  # 90 mm/s\n"), std::string::npos);
  EXPECT_EQ(dump.out, run("param dump --experiment slow.ini").out);
}

TEST_F(ParamProgram, ALinkIsRememberedWithItsKeyFile) {
  EXPECT_EQ(run("key robot.key").exit_code, 0);
  // As it was before the run, simulated robots have the test key: the other one is refused.
  const Result result = with_robot(
      "$screed send --pty radio --remember disarm\n"
      "cd ..; $screed send disarm; cd run\n"
      "$screed send --key robot.key disarm; echo \"exit $?\"\n"
      "$screed send --pty radio --key robot.key --remember disarm; echo \"exit $?\"\n"
      "$screed send disarm; echo \"exit $?\"\n"
      "$screed send --pty radio disarm; echo \"exit $?\"\n"
      "mv robot.key away.key\n"
      "$screed send disarm; echo \"exit $?\"\n"
      "$screed send estop; echo \"exit $?\"\n");
  const std::string file = log("config") + "/screed/link.ini";
  const std::string port = (std::filesystem::canonical(root_) / "radio").string();
  const std::string key = (std::filesystem::canonical(root_) / "robot.key").string();
  const std::string wrong = "disarm: refused: signed with another key than the robot's (--key)\n";
  EXPECT_EQ(result.out, "disarm: done\ndisarm: done\n" + wrong + "exit 1\n" + wrong + "exit 1\n" +
                            wrong + "exit 1\ndisarm: done\nexit 0\nexit 2\n" +
                            "estop: robot 1 has stopped\nexit 0\n");
  EXPECT_EQ(read(file).find("0123"), std::string::npos);
  EXPECT_NE(read(file).find("pty = " + port + "\nkey = " + key + "\n"), std::string::npos)
      << read(file);
  EXPECT_NE(result.err.find("pty radio: remembered in " + file + "\n"), std::string::npos)
      << result.err;
  EXPECT_NE(result.err.find("using pty " + port + ", key " + key + ", remembered in " + file),
            std::string::npos)
      << result.err;
}

TEST_F(ParamProgram, CommandsAndAnswersAreJsonForPrograms) {
  const Result result = with_robot(
      "$screed send --pty radio disarm --json; echo \"exit $?,\"\n"
      "$screed send --pty radio drive 0.1 -5 --json; echo \"exit $?,\"\n"
      "$screed send --pty radio estop --json; echo \"exit $?\"\n");
  std::vector<Json> said;
  std::istringstream out(result.out);
  for (std::string line, object; std::getline(out, line);) {
    if (line.rfind("exit", 0) == 0) {
      said.push_back(Json::parse(object));
      said.back()["exit"] = std::stoi(line.substr(5));
      object.clear();
    } else {
      object += line;
    }
  }
  ASSERT_EQ(said.size(), 3U) << result.out << result.err;
  const Json null = nullptr;
  EXPECT_EQ(said[0], (Json{{"command", "disarm"},
                           {"robot", 1},
                           {"done", true},
                           {"answer", "done"},
                           {"reason", null},
                           {"exit", 0}}));
  EXPECT_EQ(said[1], (Json{{"command", "drive"},
                           {"speed_m_per_s", 0.1},
                           {"yaw_rate_deg_per_s", -5.0},
                           {"robot", 1},
                           {"done", false},
                           {"answer", "wrong_state"},
                           {"reason", "disarmed; arm first: screed send arm"},
                           {"exit", 1}}));
  EXPECT_EQ(said[2], (Json{{"command", "estop"}, {"robot", 1}, {"done", true}, {"exit", 0}}));
}

TEST_F(ParamProgram, ANewKeyIsMadeOnceThereIsARobotToTakeIt) {
  expect_refused(run("key robot.key --port /dev/none"), 2, {"/dev/none: no such port"});
  expect_refused(run("key robot.key --port /dev/null"), 2, {"/dev/null: is no serial port"});
  EXPECT_FALSE(std::filesystem::exists(root_ / "robot.key"));
}

TEST_F(ParamProgram, WithoutALinkItSaysHowToNameOne) {
  expect_refused(run("send arm"), 2, {"--port", "--can", "--pty", "--remember"});
  expect_refused(run("monitor --port /dev/none"), 2,
                 {"/dev/none: no such port; serial ports here"});
}

}  // namespace
}  // namespace screed::testing
