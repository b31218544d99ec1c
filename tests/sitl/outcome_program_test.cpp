// What `screed sim` says about the outcome of a run: table, JSON, pictures.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

using Json = nlohmann::ordered_json;

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
  const Result result = run("sim spin.ini --json --out here");
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
  ASSERT_EQ(run("sim spin.ini --quiet --out sub/there").exit_code, 0);
  EXPECT_EQ(read(root_ / "here" / "summary.json"), read(root_ / "sub" / "there" / "summary.json"));
}

TEST_F(Outcome, SeveralRunsEachNameTheirFolder) {
  write_spin();
  write("flat.ini", "[experiment]\nname = flat\nduration = 1\n");
  const Result result = run("sim spin.ini flat.ini --json --out both --duration 1");
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
  for (const char* words :
       {"relief at robot scale", "roughness", "cut", "fill", "moved", "flat (up to 5 deg)"}) {
    EXPECT_NE(result.out.find(words), std::string::npos) << words << " in: " << result.out;
  }
  EXPECT_TRUE(std::filesystem::exists(root_ / "r" / "terrain_change.png"));
}

TEST_F(Outcome, RigidGroundHasNoPictureOfItsChange) {
  write("flat.ini", "[experiment]\nname = flat\nduration = 1\n");
  const Result result = run("sim flat.ini --out r");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_FALSE(std::filesystem::exists(root_ / "r" / "terrain_change.png"));
  EXPECT_EQ(result.out.find("change of terrain"), std::string::npos) << result.out;
  const Json summary = Json::parse(read(root_ / "r" / "summary.json"));
  EXPECT_EQ(summary["terrain_change"]["cut_m3"], 0.0);
}

TEST_F(Outcome, ARampOfTheLimitIsFlatAndASteeperOneIsNot) {
  for (const char* model : {"rigid", "scm"}) {
    const auto flatness_before = [&](const std::string& ramp) {
      write("ramp.ini", "[experiment]\nduration = 0.1\n[map]\nsize = 1\nmodel = " +
                            std::string(model) + "\nramp = " + ramp + "\n");
      const Result result = run("sim ramp.ini --json");
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
