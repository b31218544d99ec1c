// `screed sim` of several robots, and what the other commands make of such a run.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "paths.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class SeveralRobots : public Program {
 protected:
  /// Robots that drive straight on, on 1.6 m of a ground with walls.
  void write_bed(const std::string& more = "", const std::string& map = "rigid") const {
    write("bed.ini",
          "[experiment]\nname = bed\nseed = 5\nalgorithm = drive\nduration = 8\n"
          "[drive]\nspeed = 0.15\nyaw_rate = 20\n[map]\nsize = 1.6\nedges = walls\nmodel = " +
              map + "\n" + more);
  }
  void run_bed(const std::string& options) const {
    const Result result = run("sim bed.ini --quiet " + options);
    ASSERT_EQ(result.exit_code, 0) << result.err;
  }
  std::string read_run(const std::string& file) const { return read(root_ / file); }
  void expect_refused(const std::string& options, const std::string& because) const {
    const Result result = run("sim bed.ini --out refused " + options);
    EXPECT_EQ(result.exit_code, 2) << options;
    EXPECT_NE(result.err.find(because), std::string::npos) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(std::filesystem::exists(root_ / "refused"));
  }
};

TEST_F(SeveralRobots, TheSameRunTwiceIsTheSameInEveryFile) {
  write_bed("[soil]\npreset = lete_sand\ncell = 0.01\n[robots]\ncount = 3\nspacing = 0.4\n", "scm");
  run_bed("--no-pictures --out one");
  run_bed("--no-pictures --out two");
  for (const std::filesystem::path robot : {".", "robot_1", "robot_2"}) {
    for (const char* const file : {"session.h5", "frames.csv", "telemetry.log"}) {
      const std::string content = read(root_ / "one" / robot / file);
      EXPECT_FALSE(content.empty()) << robot << file;
      EXPECT_EQ(content, read(root_ / "two" / robot / file)) << robot << file;
    }
  }
  EXPECT_EQ(read_run("one/summary.json"), read_run("two/summary.json"));
  EXPECT_FALSE(std::filesystem::exists(root_ / "one/robot_3"));
}

TEST_F(SeveralRobots, SummaryHasEachOneAndTotals) {
  write_bed("[robots]\ncount = 3\nspacing = 0.4\n");
  run_bed("--no-pictures --out run");
  const Json summary = Json::parse(read_run("run/summary.json"));
  ASSERT_EQ(summary["robots"].size(), 3U);
  double distance_m = 0.0;
  double energy_j = 0.0;
  std::set<std::string> hashes = {summary["content_hash"].get<std::string>()};
  for (const Json& robot : summary["robots"]) {
    EXPECT_GT(robot["distance_m"].get<double>(), 0.2);
    EXPECT_GT(robot["telemetry_frames"].get<int>(), 100);
    EXPECT_EQ(robot["faults"], "none");
    distance_m += robot["distance_m"].get<double>();
    energy_j += robot["energy_j"].get<double>();
    hashes.insert(robot["content_hash"].get<std::string>());
  }
  EXPECT_DOUBLE_EQ(summary["distance_m"].get<double>(), distance_m);
  EXPECT_DOUBLE_EQ(summary["energy_j"].get<double>(), energy_j);
  EXPECT_EQ(hashes.size(), 4U) << "each has its own noise, and the run a hash of all";
}

TEST_F(SeveralRobots, TheFirstOneDrivesAsAloneUntilItMeetsAnother) {
  write_bed();
  run_bed("--no-pictures --out alone --set vehicle.x=-0.4");
  run_bed(
      "--no-pictures --out both --set robots.count=2 --set 'robots.placement=list' "
      "--set 'robots.places=-0.4 0 0, 0.5 0 90'");
  EXPECT_EQ(read_run("alone/frames.csv"), read_run("both/frames.csv"));
  EXPECT_NE(read_run("both/frames.csv"), read_run("both/robot_1/frames.csv"));
  EXPECT_FALSE(Json::parse(read_run("alone/summary.json")).contains("robots"));
}

TEST_F(SeveralRobots, ReplayIsOfAllOfThemOrOfOne) {
  write_bed("[robots]\ncount = 2\nspacing = 0.4\n");
  run_bed("--no-pictures --out run");
  const Result all = run("replay run");
  EXPECT_EQ(all.exit_code, 0) << all.err;
  EXPECT_NE(all.out.find("robot 0: 800 ticks replayed, outputs identical"), std::string::npos)
      << all.out;
  EXPECT_NE(all.out.find("robot 1: 800 ticks replayed, outputs identical"), std::string::npos);
  const Json json = Json::parse(run("replay run --json").out);
  ASSERT_EQ(json["further_robots"].size(), 1U);
  EXPECT_TRUE(json["further_robots"][0]["identical"].get<bool>());
  EXPECT_NE(json["output_hash"], json["further_robots"][0]["output_hash"]);

  EXPECT_EQ(run("replay run/robot_1").out, "800 ticks replayed, outputs identical\n");
  EXPECT_EQ(run("replay run/session.h5").out, "800 ticks replayed, outputs identical\n");

  write("run/robot_1/session.h5", "no session");
  EXPECT_EQ(run("replay run").exit_code, 2);
}

TEST_F(SeveralRobots, PicturesSceneAndReportShowAllOfThem) {
  write_bed("[robots]\ncount = 3\nspacing = 0.4\n");
  run_bed("--out run");
  ASSERT_EQ(run("session export run --pictures --out again").exit_code, 0);
  EXPECT_EQ(read_run("run/terrain_after.png"), read_run("again/pictures/terrain_after.png"));
  ASSERT_EQ(run("session export run/session.h5 --pictures --out first").exit_code, 0);
  EXPECT_NE(read_run("run/terrain_after.png"), read_run("first/pictures/terrain_after.png"));

  ASSERT_EQ(run("render run --pov-only --out all.png").exit_code, 0);
  ASSERT_EQ(run("render run/session.h5 --pov-only --out one.png").exit_code, 0);
  const size_t all = read_run("all.pov").size();
  const size_t one = read_run("one.pov").size();
  EXPECT_GT(all, one + (all - one) / 3) << "robots 1 and 2 are drawn";
  EXPECT_GT(all - one, one / 2);

  ASSERT_EQ(run("view run --screenshot all_view.png --at 8").exit_code, 0);
  ASSERT_EQ(run("view run/session.h5 --screenshot one_view.png --at 8").exit_code, 0);
  EXPECT_NE(read_run("all_view.png"), read_run("one_view.png"));
  ASSERT_EQ(
      run("sim bed.ini --quiet --no-pictures --out live --screenshot live_view.png").exit_code, 0);
  EXPECT_GT(read_run("live_view.png").size(), 1000U);
}

TEST_F(SeveralRobots, PlacesAreThoseOfThePlacement) {
  write_bed("[robots]\ncount = 4\nspacing = 0.6\n");
  const auto starts = [&](const std::string& options) {
    const Result result =
        run("sim bed.ini --quiet --no-pictures --duration 0.1 --out run " + options);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    std::vector<std::array<double, 2>> places;
    for (const std::filesystem::path robot : {".", "robot_1", "robot_2", "robot_3"}) {
      const std::string text = read(root_ / "run" / robot / "frames.csv");
      const std::string header = text.substr(0, text.find('\n'));
      std::string row = text.substr(text.find('\n') + 1);
      std::array<double, 2> place{};
      size_t column = 0;
      std::istringstream names(header);
      std::istringstream values(row.substr(0, row.find('\n')));
      for (std::string name, value;
           std::getline(names, name, ',') && std::getline(values, value, ',');) {
        if (name == "x [m]" || name == "y [m]") place.at(column++) = std::stod(value);
      }
      EXPECT_EQ(column, 2U) << header;
      places.push_back(place);
    }
    std::filesystem::remove_all(root_ / "run");
    return places;
  };
  const auto grid = starts("");
  const auto ring = starts("--set robots.placement=ring");
  const auto random = starts("--set robots.placement=random --set robots.spacing=0.4");
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(grid[i][0], i % 2 == 0 ? -0.3 : 0.3, 0.005);
    EXPECT_NEAR(grid[i][1], i < 2 ? -0.3 : 0.3, 0.005);
    EXPECT_NEAR(std::hypot(ring[i][0], ring[i][1]), 0.6 / std::sqrt(2.0), 0.005);
    for (int j = 0; j < i; ++j) {
      EXPECT_GT(std::hypot(random[i][0] - random[j][0], random[i][1] - random[j][1]), 0.395);
    }
  }
  EXPECT_NE(random, starts("--set robots.placement=random --set robots.spacing=0.4 --seed 6"));
}

TEST_F(SeveralRobots, ASectionOfARobotIsForThatOneAlone) {
  write_bed("[robots]\ncount = 3\nspacing = 0.6\n");
  run_bed("--no-pictures --out plain");
  write_bed(
      "[robots]\ncount = 3\nspacing = 0.6\n"
      "[robot_1]\nspeed = 0.1\n[robot_2]\nalgorithm = hill_sensing\n");
  run_bed("--no-pictures --out own");
  EXPECT_EQ(read_run("plain/frames.csv"), read_run("own/frames.csv"));
  const Json plain = Json::parse(read_run("plain/summary.json"));
  const Json own = Json::parse(read_run("own/summary.json"));
  EXPECT_NE(plain["content_hash"], own["content_hash"]);
  for (const int robot : {1, 2}) {
    const std::string file = "/robot_" + std::to_string(robot) + "/frames.csv";
    EXPECT_NE(read_run("plain" + file), read_run("own" + file)) << robot;
  }
  EXPECT_EQ(run("replay own").exit_code, 0);
  // The folder's experiment gives the same again.
  const Result again = run("sim own/experiment.ini --quiet --no-pictures --json --out again");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(Json::parse(again.out)["content_hash"], own["content_hash"]);
}

TEST_F(SeveralRobots, WhatCannotBeRunIsRefusedByOneLine) {
  write_bed();
  expect_refused("--set robots.count=2 --set map.model=scm --hal surrogate --model '" +
                     std::string(kDataFolder) + "/../../nn/models/v2_products.json'",
                 "networks move 1");
  expect_refused("--set robots.count=2 --set robots.spacing=0.1",
                 "[robots] count = 2 puts robots 0 and 1 into one another");
  expect_refused("--set map.edges=walls --set robots.count=2 --set robots.spacing=9",
                 "[robots] count = 2 puts robot 0");
  expect_refused("--set robots.count=65", "1..64");
  expect_refused("--set robots.count=2 --set robots.placement=list", "places");
  expect_refused(
      "--set robots.count=3 --set robots.placement=list "
      "--set 'robots.places=0 0 0, 0.5 0 0'",
      "places has 2");
  expect_refused("--set robots.count=2 --set 'robots.places=0 0, 0.5 0 0'", "x y heading");
  expect_refused("--set robots.count=30 --set robots.placement=random", "found no places");
  expect_refused("--set robots.count=2 --set experiment.algorithm=training_drive", "one robot");
  expect_refused("--set robots.count=2 --set robot_2.x=1", "[robot_2] x: [robots] count = 2");
}

}  // namespace
}  // namespace screed::testing
