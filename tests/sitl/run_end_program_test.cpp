// How a run that ends before its time, or on a full disk, leaves its folder, and what the program
// then ends with.
#include "host_sim/core/json.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class RunEnds : public Program {
 protected:
  /// Of the first robot that drives straight on, 0.2 m/s.
  void write_drive(double size_m, double duration_s) const {
    write("e.ini",
          "[experiment]\nname = e\nalgorithm = drive\nduration = " + std::to_string(duration_s) +
              "\n[drive]\nspeed = 0.2\n[map]\nsize = " + std::to_string(size_m) + "\n");
  }
  bool exists(const std::string& name) const { return std::filesystem::exists(root_ / name); }
};

TEST_F(RunEnds, OneThatASignalEndsIsWholeAndTheProgramNamesTheSignal) {
  write_drive(500.0, 1e6);
  struct Case {
    const char* signal;
    int exit_code;
  };
  for (const Case& it : {Case{"HUP", 129}, Case{"INT", 130}, Case{"TERM", 143}}) {
    const std::string out = it.signal;
    // Until the session has its first block of frames. A program that has ended has no open files.
    write("begun",
          "until [ \"$(find " + out +
              ".partial -name session.h5 -size +100k)\" ] || ! [ -e /proc/$1/fd/1 ]; do :; "
              "done 2> /dev/null\n");
    const Result result = run(std::string("sim e.ini --quiet --no-pictures --out ") + it.signal +
                              " & pid=$!; sh begun $pid; kill -" + it.signal + " $pid; wait $pid");
    EXPECT_EQ(result.exit_code, it.exit_code) << it.signal << ": " << result.err;
    EXPECT_FALSE(exists(out + ".partial")) << it.signal;
    EXPECT_TRUE(exists(out + "/session.h5")) << it.signal;
    EXPECT_NE(read(root_ / out / "summary.json").find("\"stopped_early\": true"), std::string::npos)
        << it.signal;
    EXPECT_EQ(run("replay " + out).exit_code, 0) << it.signal;
  }
}

TEST_F(RunEnds, OnRigidGroundToWhereTheRobotLeavesTheBed) {
  write_drive(1.0, 60.0);
  const Result result = run("sim e.ini --quiet --no-pictures --out r");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("note: e: ended after "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find(" s: the robot left the bed\n"), std::string::npos) << result.err;
  const std::string summary = read(root_ / "r" / "summary.json");
  EXPECT_NE(summary.find("\"left_bed\": true"), std::string::npos) << summary;
  EXPECT_EQ(run("replay r").exit_code, 0);
}

TEST_F(RunEnds, EachOfSeveralThatLeftTheBedIsNamed) {
  write_drive(1.0, 60.0);
  const std::string text = read(root_ / "e.ini");
  write("f.ini", "[experiment]\nname = f\n" + text.substr(text.find("algorithm")));
  const Result result = run("sim e.ini f.ini --quiet --no-pictures --out both");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("note: e: ended after "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("note: f: ended after "), std::string::npos) << result.err;
}

// The last line says why, and the exit code that something is wrong.
TEST_F(RunEnds, ARobotThatNeverRanIsAFailure) {
  write_drive(5.0, 12.0);
  const std::string never = "sim e.ini --quiet --no-pictures --set parameters.battery_low=12000";
  const Result result = run(never + " --out r");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_TRUE(result.err.starts_with("note: e: the robot never ran: battery ")) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(run(never + " --duration 9 --out s").exit_code, 0) << "it had no time to";
  EXPECT_EQ(run(never + " --set radio.ground_station=false --out n").exit_code, 0)
      << "nobody told it to";
}

// What is left of its charge lasts some minutes.
TEST_F(RunEnds, AnEmptyBatteryStopsTheRobot) {
  write_drive(50.0, 120.0);
  const Result result = run(
      "sim e.ini --quiet --no-pictures --set battery.charge=0.02 --set battery.capacity=0.5 --out "
      "r");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err, "note: e: the robot is stopped by a fault: battery\n");
  const auto summary = Json::parse(read(root_ / "r/summary.json"));
  EXPECT_LT(summary["battery_charge"].get<double>(), 0.02);
  EXPECT_GT(summary["distance_m"].get<double>(), 1.0);
  // At 0.3 to 1 A.
  EXPECT_GT(summary["charge_lasts_h"].get<double>(), 0.5);
  EXPECT_LT(summary["charge_lasts_h"].get<double>(), 2.0);
}

TEST_F(RunEnds, ARobotThatAFaultStopsIsAFailure) {
  write_drive(5.0, 12.0);
  const Result result =
      run("sim e.ini --quiet --no-pictures --set experiment.lay_on_side_at=8 --out r");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(result.err, "note: e: the robot is stopped by a fault: tilt\n");
}

TEST_F(RunEnds, AFolderOfTheNameDoesNotHideAnExperimentThatComesAlong) {
  std::filesystem::create_directories(root_ / "first_drive");
  const Result result = run("sim first_drive --quiet --no-pictures --duration 0.1 --out r");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(RunEnds, WithItsSessionWhereTheDiskIsFullForTheTable) {
  write_drive(5.0, 10.0);
  // A limit on the size of files, 480 blocks of 512 or 1024 bytes, stands for a full disk: the
  // session of 1000 frames stays below it (195 kB), the table of their columns does not (590 kB).
  const Result result = run("sim e.ini --quiet --out r", "trap '' XFSZ; ulimit -f 480;");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find("frames.csv: "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("the session is whole, in r\n"), std::string::npos) << result.err;
  EXPECT_FALSE(exists("r.partial"));
  EXPECT_FALSE(exists("r/frames.csv"));
  EXPECT_EQ(run("replay r").exit_code, 0);
  EXPECT_NE(read(root_ / "r" / "summary.json").find("content_hash"), std::string::npos);
}

TEST_F(RunEnds, ARefusedExportLeavesNoFolder) {
  write_drive(1.0, 0.1);
  ASSERT_EQ(run("sim e.ini --quiet --no-pictures --out r").exit_code, 0);
  const Result result = run("session export r --csv --all --out a/b", "trap '' XFSZ; ulimit -f 0;");
  EXPECT_EQ(result.exit_code, 1) << result.err;
  EXPECT_FALSE(exists("a"));
  ASSERT_EQ(run("session export r --csv --all --out a/b").exit_code, 0);
  EXPECT_TRUE(exists("a/b/frames.csv"));
}

TEST_F(RunEnds, AtItsTimeWithNothingToSay) {
  write_drive(1.0, 0.5);
  const Result result = run("sim e.ini --quiet --no-pictures --out r");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.err, "");
}

}  // namespace
}  // namespace screed::testing
