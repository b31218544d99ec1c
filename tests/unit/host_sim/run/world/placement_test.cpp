// What is put where: keys of single robots, traps.
#include <gtest/gtest.h>
#include <cmath>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/robot_sections.h"
#include "host_sim/run/simulation/simulation.h"
#include "host_sim/run/world/placement.h"
#include "host_sim/run/world/world_setup.h"
#include "tests/temp_folder.h"

namespace screed {

namespace {

// Sections of single robots: read as the others are, in force for that robot alone.

class RobotSections : public ::testing::Test {
 protected:
  Experiment read(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    std::ofstream(path_) << text;
    return read_experiment(path_, overrides);
  }
  /// What is said about the text, without the name of the file.
  std::string complaint(const std::string& text,
                        const std::vector<std::string>& overrides = {}) const {
    try {
      read(text, overrides);
    } catch (const InputError& error) {
      std::string what = error.what();
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
      if (what.rfind(path_.string(), 0) == 0) what.erase(0, path_.string().size());
      return what;
    }
    return "";
  }

  TempFolder folder_;
  std::filesystem::path path_ = folder_.path() / "test.ini";
};

constexpr const char* kThree =
    "[robots]\ncount = 3\n[robot_2]\nx = 0.7\nalgorithm = drive\nspeed = 0.2\nclimb_speed = 120\n"
    "[robot_1]\nh = 45\n";

TEST_F(RobotSections, AreInForceForTheirRobotAlone) {
  const Experiment experiment = read(kThree);
  const Experiment defaults;
  EXPECT_EQ(experiment.experiment.algorithm, defaults.experiment.algorithm);
  EXPECT_EQ(experiment.parameters.climb_speed(), defaults.parameters.climb_speed());
  const Experiment second = experiment_of_robot(experiment, 2);
  EXPECT_EQ(second.vehicle.x_m, 0.7);
  EXPECT_EQ(second.drive.speed_m_per_s, 0.2);
  EXPECT_EQ(second.experiment.algorithm, "drive");
  EXPECT_EQ(second.parameters.algorithm(), algorithm_number("drive"));
  EXPECT_EQ(second.parameters.climb_speed(), 120);
  const Experiment first = experiment_of_robot(experiment, 1);
  EXPECT_EQ(first.vehicle.heading_deg, 45.0);
  EXPECT_EQ(first.parameters.climb_speed(), defaults.parameters.climb_speed());
  EXPECT_TRUE(robot_has_own(experiment, 2, "parameters", "climb_speed"));
  EXPECT_FALSE(robot_has_own(experiment, 1, "parameters", "climb_speed"));
}

TEST_F(RobotSections, TextGivesThemAgainInOneOrder) {
  const std::string text = read(kThree).text();
  const std::string end =
      "\n[robot_1]\nh = 45\n\n[robot_2]\nx = 0.7\nalgorithm = drive\nspeed = 0.2\n"
      "climb_speed = 120\n";
  ASSERT_GT(text.size(), end.size());
  EXPECT_EQ(text.substr(text.size() - end.size()), end);
  EXPECT_EQ(read(text).text(), text);
  EXPECT_EQ(read("[robots]\ncount = 3\n").text() + end, text) << "nothing else has changed";
  EXPECT_EQ(read(kThree, {"robot_2.x=0.9"}).of_robots.size(), read(kThree).of_robots.size());
  EXPECT_EQ(experiment_of_robot(read(kThree, {"robot_2.x=0.9"}), 2).vehicle.x_m, 0.9);
}

TEST_F(RobotSections, PlacesAreOnTopOfThoseOfAll) {
  const HeightField bed = HeightField::flat(4.0, 0.1);
  const std::vector<RobotPlace> plain = robot_places(read("[robots]\ncount = 3\n"), bed);
  const std::vector<RobotPlace> own = robot_places(read(kThree, {"robot_0.y=-1"}), bed);
  ASSERT_EQ(own.size(), 3U);
  EXPECT_EQ(own[0].x_m, plain[0].x_m);
  EXPECT_EQ(own[0].y_m, -1.0);
  EXPECT_EQ(own[1].x_m, plain[1].x_m);
  EXPECT_EQ(own[1].heading_deg, 45.0);
  EXPECT_EQ(own[2].x_m, 0.7);
  EXPECT_EQ(own[2].y_m, plain[2].y_m);
}

TEST_F(RobotSections, FirmwareGetsItsOwnParametersAndASeedThatWasSaid) {
  const Experiment experiment = read(kThree, {"robot_1.random_seed=77"});
  const std::vector<RobotOptions> robots = robot_options(experiment, kDefaultBoard);
  ASSERT_EQ(robots.size(), 3U);
  EXPECT_EQ(robots[0].settings.parameters.random_seed(), experiment.parameters.random_seed());
  EXPECT_EQ(robots[1].settings.parameters.random_seed(), 77);
  EXPECT_EQ(robots[2].settings.parameters.random_seed(),
            parameters_of_robot(experiment.parameters, 2).random_seed());
  EXPECT_EQ(robots[1].settings.parameters.climb_speed(), experiment.parameters.climb_speed());
  EXPECT_EQ(robots[2].settings.parameters.climb_speed(), 120);
  EXPECT_EQ(robots[2].settings.parameters.algorithm(), algorithm_number("drive"));
}

TEST_F(RobotSections, NoTwoKeysHaveOneName) {
  std::set<std::string> names;
  for (const ExperimentKey& key : robot_section_keys(kMaxRobots - 1)) {
    EXPECT_TRUE(names.insert(key.name).second) << key.name;
  }
}

TEST_F(RobotSections, ComplaintsAreOfOneLine) {
  const std::string count = "[robots]\ncount = 2\n";
  EXPECT_EQ(complaint(count + "[robot_1]\nx = far\n"),
            ":4: [robot_1] x = 'far' is not allowed; expected a number -500..500 (m)");
  EXPECT_EQ(complaint(count + "[robot_1]\nmodel = rover5\n")
                .rfind(":4: unknown key 'model' in [robot_1]; did you mean [vehicle] model or "
                       "[map] model; known "
                       "are x, y, h, algorithm, speed, ",
                       0),
            0U);
  EXPECT_EQ(
      complaint(count + "[robot_0]\nclimb_speed = 100\n"),
      ":4: unknown key 'climb_speed' in [robot_0]; did you mean [parameters] climb_speed; known "
      "are x, y, h");
  EXPECT_EQ(
      complaint(count + "[robot_2]\nx = 1\n"),
      ":4: [robot_2] x: [robots] count = 2; sections of robots are for those of several, from "
      "[robot_0] on");
  EXPECT_NE(complaint("[robot_0]\nx = 1\n").find("[robots] count = 1"), std::string::npos);
  for (const char* const section : {"[robot_64]", "[robot_01]", "[robot_]", "[robot_-1]"}) {
    EXPECT_EQ(complaint(count + section + "\nx = 1\n")
                  .rfind(std::string(":4: unknown section ") + section, 0),
              0U)
        << section;
  }
  EXPECT_NE(
      complaint(count + "[robot_1]\nalgorithm = training_drive\n").find("[robot_1] algorithm"),
      std::string::npos);
  EXPECT_EQ(complaint(count + "[robot_1]\nwalk_speed_min = 200\nwalk_speed_max = 100\n")
                .rfind(":4: [robot_1] walk_speed_min = 200 is above [robot_1] walk_speed_max", 0),
            0U);
  EXPECT_EQ(complaint(count, {"robot_1.h=1000"}),
            "--set: [robot_1] h = '1000' is not allowed; expected a number -360..360 (deg)");
}

// Traps that an experiment cuts into its terrain.

/// Level ground with a trap; the start 0.2 m east of the middle, heading north.
HeightField with_trap(const char* kind, double distance_m, double size) {
  Experiment experiment;
  experiment.vehicle.x_m = 0.2;
  experiment.vehicle.heading_deg = 90.0;
  experiment.trap.kind = kind;
  experiment.trap.distance_m = distance_m;
  experiment.trap.size = size;
  HeightField field = HeightField::flat(4.0, 0.01);
  set_trap(experiment, field);
  return field;
}

double height(const HeightField& field, double x, double y) {
  return field.at(x, y).height;
}

TEST(Trap, NoneChangesNothing) {
  EXPECT_EQ(with_trap("none", 0.5, 0.1).height_sum(), 0);
  EXPECT_EQ(trap_kinds().front(), "none");
}

TEST(Trap, AWallStandsAllRoundTheStart) {
  const HeightField field = with_trap("wall", 0.5, 0.15);
  EXPECT_NEAR(height(field, 0.2, 0.0), 0.0, 1e-6);
  EXPECT_NEAR(height(field, 0.2, 0.48), 0.0, 1e-6);
  for (const double turn : {0.0, 1.0, 2.0, 4.0}) {
    EXPECT_NEAR(height(field, 0.2 + 0.55 * std::cos(turn), 0.55 * std::sin(turn)), 0.15, 1e-6);
  }
}

TEST(Trap, ASlopeRisesByItsAngleAndEnds) {
  const HeightField field = with_trap("slope", 0.4, 30.0);
  EXPECT_NEAR(height(field, 0.2, 0.9) - height(field, 0.2, 0.8), 0.1 * std::tan(0.5235988), 1e-4);
  EXPECT_NEAR(height(field, 0.2, 1.8), height(field, 0.2, 1.7), 1e-6);
}

TEST(Trap, HumpAndRutsLieAheadUnderTheRobot) {
  const HeightField hump = with_trap("hump", 0.3, 0.06);
  EXPECT_NEAR(height(hump, 0.2, 0.5), 0.06, 1e-6);
  EXPECT_NEAR(height(hump, 0.3, 0.5), 0.0, 1e-6);
  EXPECT_NEAR(height(hump, 0.5, 0.0), 0.0, 1e-6);
  const HeightField ruts = with_trap("ruts", -0.25, 0.05);
  EXPECT_NEAR(height(ruts, 0.2, 0.0), 0.0, 1e-6);
  EXPECT_NEAR(height(ruts, 0.2 + 0.0975, 0.0), -0.05, 1e-6);
  EXPECT_NEAR(height(ruts, 0.2 - 0.0975, 0.2), -0.05, 1e-6);
  EXPECT_NEAR(height(ruts, 0.2 - 0.0975, 0.4), 0.0, 1e-6);
}

TEST(Trap, TheTerrainOfAnExperimentHasIt) {
  Experiment experiment;
  experiment.trap.kind = "trench";
  experiment.trap.distance_m = 0.4;
  experiment.trap.size = 0.07;
  EXPECT_NEAR(height(make_terrain(experiment), 0.58, 0.0), -0.07, 0.01);
}

}  // namespace

}  // namespace screed
