// What `screed sim` says about the outcome of a run: table, JSON, pictures.
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class Outcome : public Program {
 protected:
  /// A robot that spins on soil of 10 mm cells.
  void write_spin(const std::string& more = "") const {
    write(
        "spin.ini",
        "[experiment]\nname = spin\nseed = 5\nalgorithm = drive\nduration = 10\n"
        "[drive]\nspeed = 0\nyaw_rate = 90\n[map]\nsize = 1\nmodel = scm\n[soil]\npreset = gravel\n"
        "drag_depth = 0.002\ncell = 0.01\n" +
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

}  // namespace
}  // namespace screed::testing
