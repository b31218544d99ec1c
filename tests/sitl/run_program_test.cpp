// Runs and batches as a user meets them: what they say, how they end.
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

// What `screed sim` says about the outcome of a run: table, JSON, pictures.

class Outcome : public Program {
 protected:
  /// A robot that spins on soil of 10 mm cells.
  void write_spin(const std::string& more = "") const {
    write(
        "spin.ini",
        "[experiment]\nname = spin\nseed = 5\nalgorithm = drive\nduration = 10\n"
        "[drive]\nspeed = 0\nyaw_rate = 90\n[map]\nsize = 1\nmodel = scm\n[soil]\npreset = gravel\n"
        "slip_layer = 0.002\ncell = 0.01\n" +
            more);
  }
};

TEST_F(Outcome, JsonSaysWhichRunItWas) {
  write_spin();
  const Result result = run("sim spin.ini --no-pictures --json --out here");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  Json printed = Json::parse(result.out);
  EXPECT_EQ(printed["run_folder"], "here");
  EXPECT_EQ(printed["name"], "spin");
  EXPECT_EQ(printed["seed"], 5);
  EXPECT_EQ(printed["algorithm"], "drive");
  const Json world = {
      {"hal", "native"}, {"board", "a_star_32u4"}, {"terrain", "scm"}, {"soil", "gravel"}};
  EXPECT_EQ(printed["world"], world);
  const auto version = printed["version"].get<std::string>();
  EXPECT_FALSE(version.empty());
  EXPECT_NE(run("--version").out.find(version), std::string::npos) << version;

  printed.erase("run_folder");
  EXPECT_EQ(printed.dump(2) + "\n", read(root_ / "here" / "summary.json"));
  ASSERT_EQ(run("sim spin.ini --quiet --no-pictures --out sub/there").exit_code, 0);
  EXPECT_EQ(read(root_ / "here" / "summary.json"), read(root_ / "sub" / "there" / "summary.json"));
}

TEST_F(Outcome, SeveralRunsEachNameTheirFolder) {
  write_spin();
  write("flat.ini", "[experiment]\nname = flat\nduration = 1\n");
  const Result result = run("sim spin.ini flat.ini --no-pictures --json --out both --duration 1");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json runs = Json::parse(result.out);
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_EQ(runs[0]["run_folder"], "both/spin-0001");
  EXPECT_EQ(runs[1]["run_folder"], "both/flat-0001");
  EXPECT_TRUE(runs[1]["world"]["soil"].is_null());
  EXPECT_EQ(runs[1]["world"]["terrain"], "rigid");
}

TEST_F(Outcome, ASpinDigsAndTheSummarySaysHowMuch) {
  write_spin();
  const Result result = run("sim spin.ini --out r");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json summary = Json::parse(read(root_ / "r" / "summary.json"));
  const Json& change = summary["terrain_change"];
  EXPECT_GT(change["moved_m3"].get<double>(), 1e-6);
  EXPECT_EQ(change["moved_m3"],
            std::min(change["cut_m3"].get<double>(), change["fill_m3"].get<double>()));
  EXPECT_GT(change["deepest_cut_m"].get<double>(), 0.001);
  EXPECT_LT(change["deepest_cut_m"].get<double>(), 0.2);
  EXPECT_GT(change["deepest_fill_m"].get<double>(), 0.0005);
  EXPECT_EQ(summary["terrain_before"]["roughness_m"], 0.0);
  EXPECT_GT(summary["terrain_after"]["roughness_m"].get<double>(), 1e-5);
  EXPECT_GT(summary["terrain_after"]["relief_m"].get<double>(), 1e-5);
  for (const char* words : {"height about level", "relief at robot scale", "roughness", "cut",
                            "fill", "moved", "flat cells, up to 5 deg"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words << " in: " << result.out;
  }
  EXPECT_TRUE(std::filesystem::exists(root_ / "r" / "terrain_change.png"));
}

TEST_F(Outcome, TheLevelingCurveIsInTheSummaryTheSessionAndItsCsv) {
  write_spin("[metrics]\ninterval = 2.5\ntransport_interval = 5\n");
  const Result result = run("sim spin.ini --no-pictures --out r");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* words : {"flat at robot scale", "transport to level ground", "time stuck"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words << " in: " << result.out;
  }
  const Json summary = Json::parse(read(root_ / "r" / "summary.json"));
  const Json& leveling = summary["leveling"];
  EXPECT_EQ(leveling["transport_before_m4"], 0.0) << "the bed was level";
  EXPECT_TRUE(leveling["progress"].is_null());
  EXPECT_TRUE(leveling["progress_w2"].is_null());
  EXPECT_GT(leveling["transport_after_m4"].get<double>(), 0.0);
  EXPECT_LT(leveling["transport_per_joule_m4"].get<double>(), 0.0) << "digging levels no bed";

  const std::string csv = read(root_ / "r" / "leveling.csv");
  std::istringstream lines(csv);
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);) rows.push_back(line);
  ASSERT_EQ(rows.size(), 6U) << "header, start, three points, end: " << csv;
  EXPECT_TRUE(rows[0].starts_with("time [s],level_deviation [m],relief [m],")) << rows[0];
  EXPECT_TRUE(rows[1].starts_with("0,0,0,0,1,1,0,0,0,0,nan,nan,0,0,")) << rows[1];
  EXPECT_TRUE(rows[2].starts_with("2.5")) << rows[2];
  EXPECT_NE(rows[2].find(",nan,nan,nan,nan,nan,"), std::string::npos) << rows[2];
  EXPECT_EQ(rows[3].find(",nan,nan,nan,nan,nan,"), std::string::npos) << rows[3];

  ASSERT_EQ(run("session export r --leveling --out again").exit_code, 0);
  EXPECT_EQ(read(root_ / "again" / "leveling.csv"), csv);
}

TEST_F(Outcome, MeasuringMoreOftenChangesNothingElse) {
  write_spin();
  const std::string arguments = "sim spin.ini --no-pictures --json --duration 3";
  const Json rare = Json::parse(run(arguments + " --out a").out);
  const Json often = Json::parse(run(arguments + " --set metrics.interval=0.1 --out b").out);
  EXPECT_EQ(rare["leveling"], often["leveling"]);
  EXPECT_EQ(rare["terrain_after"], often["terrain_after"]);
  EXPECT_EQ(read(root_ / "a" / "frames.csv"), read(root_ / "b" / "frames.csv"));
  const Json defaults = Json::parse(run(arguments + " --set metrics.interval=30 --out c").out);
  EXPECT_EQ(defaults["content_hash"], rare["content_hash"]);
}

TEST_F(Outcome, WithoutPicturesIsTheSameRunAndThePicturesComeLater) {
  write_spin();
  const auto hash = [this](const std::string& arguments) {
    const Result result = run("sim spin.ini --duration 1 --json " + arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out)["content_hash"].get<std::string>();
  };
  EXPECT_EQ(hash("--out drawn"), hash("--no-pictures --out plain"));
  ASSERT_EQ(run("session export plain --pictures --out later").exit_code, 0);
  for (const char* file :
       {"terrain_before.png", "terrain_after.png", "terrain_change.png", "leveling.png"}) {
    EXPECT_FALSE(std::filesystem::exists(root_ / "plain" / file)) << file;
    EXPECT_TRUE(read(root_ / "drawn" / file) == read(root_ / "later" / "pictures" / file)) << file;
  }
  EXPECT_EQ(read(root_ / "drawn" / "summary.json"), read(root_ / "plain" / "summary.json"));
}

TEST_F(Outcome, RigidGroundHasNoPictureOfItsChange) {
  write("flat.ini", "[experiment]\nname = flat\nduration = 1\n");
  const Result result = run("sim flat.ini --out r");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(std::filesystem::exists(root_ / "r" / "terrain_change.png"));
  EXPECT_EQ(result.out.find("change of terrain"), std::string::npos) << result.out;
  const Json summary = Json::parse(read(root_ / "r" / "summary.json"));
  EXPECT_EQ(summary["terrain_change"]["cut_m3"], 0.0);
  EXPECT_TRUE(summary["leveling"]["transport_after_m4"].is_null());
  EXPECT_EQ(result.out.find("transport"), std::string::npos) << result.out;
  EXPECT_EQ(summary["leveling"]["stuck"], 0.0);
}

TEST_F(Outcome, ARampOfTheLimitIsFlatAndASteeperOneIsNot) {
  for (const char* model : {"rigid", "scm"}) {
    const auto flatness_before = [&](const std::string& ramp) {
      write("ramp.ini", "[experiment]\nduration = 0.1\n[map]\nsize = 1\nmodel = " +
                            std::string(model) + "\nramp = " + ramp + "\n");
      const Result result = run("sim ramp.ini --no-pictures --json");
      EXPECT_EQ(result.exit_code, 0) << result.err;
      return Json::parse(result.out)["terrain_before"]["flatness"].get<double>();
    };
    EXPECT_EQ(flatness_before("4.99"), 1.0) << model;
    EXPECT_EQ(flatness_before("5"), 1.0) << model;
    EXPECT_EQ(flatness_before("5.01"), 0.0) << model;
  }
}

// How a run that ends before its time, or on a full disk, leaves its folder, and what the program
// then ends with.

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

// `screed sim --from RUN --at S`: closed loop from a moment of a recorded run on.

class OnceMore : public Program {
 protected:
  Json recorded() {
    const Result result =
        run("sim level_bed --hal surrogate --set experiment.algorithm=random_walk --duration 16 "
            "--set robots.count=2 --no-pictures --json --out was");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  }
};

TEST_F(OnceMore, TheRunIsTheRecordedOneUpToTheMomentAndReplays) {
  const Json was = recorded();
  const std::string change = " --set parameters.walk_speed_max=250 --no-pictures --json --out is";
  const Result result = run("sim --from was --at 11" + change);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json is = Json::parse(result.out);
  EXPECT_EQ(is["world"], was["world"]);
  EXPECT_EQ(is["time_s"], 16.0);
  EXPECT_GT(is["parts_from"]["time_s"], 11.0);
  EXPECT_LT(is["parts_from"]["time_s"], 12.0);
  EXPECT_GT(is["distance_m"], was["distance_m"]);
  EXPECT_EQ(run("replay is").exit_code, 0);
  // Its experiment says all of it.
  const Result again = run("sim is/experiment.ini --hal surrogate --no-pictures --json --out more");
  EXPECT_EQ(Json::parse(again.out)["content_hash"], is["content_hash"]);
}

TEST_F(OnceMore, WhatCannotBeChangedThenIsRefused) {
  recorded();
  const std::string from = "sim --from was --at 11 --out is --set ";
  expect_refused(run(from + "parameters.stroke_time=900"), 2,
                 {"stroke_time", "[later]", "known are at, climb_threshold"});
  expect_refused(run(from + "map.size=2"), 2, {"map.size=2", "allowed is parameters.KEY"});
  expect_refused(run(from + "parameters.walk_speed_max=20"), 2, {"[later] walk_speed_min = 60"});
  expect_refused(run("sim --from was --at 16 --set parameters.yaw_kp=9"), 2,
                 {"--at 16", "lasts 16 s"});
  expect_refused(run("sim --from was --set parameters.yaw_kp=9"), 2, {"--from needs --at"});
  expect_refused(run("sim x.ini --from was --at 3 --set parameters.yaw_kp=9"), 2, {"without FILE"});
}

TEST_F(OnceMore, ARunOfAnotherWorldIsNoted) {
  recorded();
  std::filesystem::remove(root_ / "was" / "summary.json");  // which says what world
  const Result result =
      run("sim --from was --at 11 --set parameters.walk_speed_max=250 --duration 12 --no-pictures "
          "--quiet --out is");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_NE(result.err.find("was recorded by another program, in another world"), std::string::npos)
      << result.err;
}

// Batches from a table, as a user meets them: `screed record FILE --table CSV` and what it leaves
// out when it is run again.

class BatchTable : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("level.ini", "[map]\nsize = 4\n[experiment]\nframes = 8\n");
    write("level.csv",
          "# of all kinds\nexperiment.name,vehicle.h,experiment.seed + parameters.random_seed\n"
          "a_1,30,5\na_2,,6\nb_1,90,7\n");
  }
  bool exists(const std::string& path) const { return std::filesystem::exists(root_ / path); }
  std::string hash_of(const std::string& folder) const {
    return Json::parse(run("session info --json " + folder).out)["content_hash"].text();
  }
};

TEST_F(BatchTable, ARowIsTheSessionOfAFileWithItsValues) {
  const Result result = run("record level.ini --table level.csv --out sets --quiet --no-pictures");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  write("b.ini",
        "[vehicle]\nh = 90\n[map]\nsize = 4\n[experiment]\nname = b_1\nframes = 8\nseed = 7\n"
        "[parameters]\nrandom_seed = 7\n");
  ASSERT_EQ(run("record b.ini --out b --quiet --no-pictures").exit_code, 0);
  EXPECT_EQ(hash_of("sets/b_1-0001"), hash_of("b"));
  EXPECT_EQ(read(root_ / "sets/b_1-0001/experiment.ini"), read(root_ / "b/experiment.ini"));
  EXPECT_TRUE(exists("sets/a_1-0001/session.h5"));
  EXPECT_TRUE(exists("sets/a_2-0001/session.h5"));
}

TEST_F(BatchTable, MissingRunsAreMadeAndOthersStay) {
  const std::string command = "record level.ini --no-pictures --table level.csv --out sets --json ";
  // One row alone goes into the folder as well, and is a list of one.
  const Result first = run(command + "--rows 'b*'");
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(Json::parse(first.out).size(), 1U);
  ASSERT_TRUE(exists("sets/b_1-0001"));
  EXPECT_FALSE(exists("sets/a_1-0001"));

  const Result second = run(command + "--missing");
  ASSERT_EQ(second.exit_code, 0) << second.err;
  EXPECT_EQ(Json::parse(second.out).size(), 2U);
  EXPECT_NE(second.err.find("note: 1 of 3 have a run already\n"), std::string::npos) << second.err;
  EXPECT_FALSE(exists("sets/b_1-0002"));

  const Result third = run(command + "--missing --quiet");
  EXPECT_EQ(third.exit_code, 0) << third.err;
  EXPECT_EQ(Json::parse(third.out), Json::array());
  EXPECT_EQ(third.err, "note: 3 of 3 have a run already\n");
}

TEST_F(BatchTable, MissingTellsWhatIsNotTheRunThatIsAskedFor) {
  const std::string command =
      "record level.ini --table level.csv --missing --out sets --quiet --no-pictures ";
  ASSERT_EQ(run(command).exit_code, 0);
  const std::string summary = "sets/a_1-0001/summary.json";
  Json ended = Json::parse(read(root_ / summary));
  ended["stopped_early"] = true;
  write(summary, ended.dump());
  EXPECT_EQ(run(command).err,
            "note: sets/a_1-0001 ended early; remove it, then --missing runs it again\n"
            "note: 3 of 3 have a run already\n");
  EXPECT_EQ(run(command + "--rows a_2 --frames 16").err,
            "note: sets/a_2-0001 is a run of other values; remove it, then --missing runs it "
            "again\nnote: 1 of 1 have a run already\n");

  std::filesystem::rename(root_ / "sets/b_1-0001", root_ / "sets/b_1-0001.partial");
  const Result left = run(command);
  EXPECT_EQ(left.exit_code, 2);
  EXPECT_NE(left.err.find("sets/b_1-0001.partial: left over"), std::string::npos) << left.err;
  std::filesystem::remove_all(root_ / "sets/b_1-0001.partial");
  std::filesystem::create_directories(root_ / "sets/b_1-0001");
  const Result empty = run(command);
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_NE(empty.err.find("sets/b_1-0001: is no run"), std::string::npos) << empty.err;
}

TEST_F(BatchTable, SimulationsTakeTablesToo) {
  const Result result = run(
      "sim level.ini --table level.csv --rows a_1 --duration 0.1 --out sims --quiet --no-pictures");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(exists("sims/a_1-0001/session.h5"));
}

TEST_F(BatchTable, NothingIsRunWhenARowIsWrong) {
  write("wrong.csv", "experiment.name,vehicle.h\ngood,1\nbad,400\n");
  expect_refused(run("record level.ini --table wrong.csv"), 2,
                 {"wrong.csv:3: row 'bad', column 'vehicle.h'", "expected a number -360..360"});
  write("image.csv", "experiment.name,map.filename\ngood,\nbad,nothing.png\n");
  expect_refused(run("record level.ini --table image.csv"), 2,
                 {"experiment bad: image.csv:3: row 'bad', column 'map.filename': [map] filename = "
                  "'nothing.png'",
                  "no such file"});
  expect_refused(run("record level.ini --table none.csv"), 2, {"none.csv: no such table"});
  expect_refused(run("record level.ini level.ini --table level.csv"), 2,
                 {"--table needs one FILE"});
  expect_refused(run("record level.ini --table level.csv --rows c*"), 2,
                 {"--rows c*: no row has such a name; names are a_1, a_2, b_1"});
  expect_refused(run("record level.ini --rows a_1"), 2, {"--rows", "--table"});
}

}  // namespace
}  // namespace screed::testing
