// The stand-in judged beside recorded drives, as its page says: a short drive of the shipped table.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <vector>

#include "host_sim/core/data_folders.h"
#include "host_sim/run/world/prepared_world.h"
#include "paths.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

class StandIn : public Program {
 protected:
  /// The folder of a minute's drive of the table.
  std::string recorded(const std::string& row) {
    const std::string folder = std::string(kDataFolder) + "/experiments/sessions/standin";
    const Result result =
        run("record '" + folder + "/standin.ini' --table '" + folder + "/standin.csv' --rows " +
            row + " --frames 6000 --missing --quiet --no-pictures --out drives");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return "drives/" + row + "-0001";
  }
};

std::vector<std::string> words_behind(const std::string& text, const std::string& name) {
  std::istringstream line(text.substr(text.find(name) + name.size()));
  std::vector<std::string> words;
  for (std::string word; words.size() < 8 && line >> word;) words.push_back(word);
  return words;
}

TEST_F(StandIn, ItsGroundBecomesWhatTheRecordedOneBecame) {
  const std::string drive = recorded("c_gravel_turns");
  const Result result = run("nn ground " + drive + " --seconds 60");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  // s, change, error, its share, moved, by the stand-in, its share, lost
  const std::vector<std::string> found = words_behind(result.out, "c_gravel_turns");
  ASSERT_EQ(found.size(), 8U) << result.out;
  EXPECT_GT(std::stod(found[0]), 30.0);
  EXPECT_GT(std::stod(found[1]), 0.02) << "it has dug";
  EXPECT_LT(std::stod(found[3]), 30.0) << "error, % of the change";
  EXPECT_GT(std::stod(found[6]), 70.0) << "moved, % of what was";
  EXPECT_LT(std::stod(found[6]), 140.0);
  EXPECT_EQ(found[7], "0");
}

TEST_F(StandIn, ItsRolloutsStandBesideBaselinesOfTheVeryDrive) {
  const std::string drive = recorded("c_viper_straight");
  for (const char* how : {"tracks", "firmware"}) {
    std::string command = "nn rollout ";
    command.append(drive).append(" --drive ").append(how);
    const Result result = run(command);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    for (const char* name : {"stand-in", "no slip", "constant slip", "slip by slope",
                             "rotation centres", "centres and slope"}) {
      EXPECT_NE(result.out.find(name), std::string::npos) << name << "\n" << result.out;
    }
    // Number of rollouts, place, its 90 %, heading, after a metre and after five.
    const std::vector<std::string> found = words_behind(result.out, "stand-in");
    ASSERT_GE(found.size(), 3U);
    EXPECT_GT(std::stoi(found[1]), 0) << result.out;
    EXPECT_LT(std::stod(found[2]), 10.0) << result.out;
  }
}

TEST_F(StandIn, APreparedWorldIsOneFileOrNone) {
  const Result result = run("prepare level_bed --set robots.count=2 --out two.world");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::ifstream file(root_ / "two.world", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  EXPECT_EQ(prepared_from(bytes).options.robots.size(), 2U);
  expect_refused(run("prepare level_bed"), 2, {"--out"});
  expect_refused(run("prepare gravel_bed --out a.world"), 2, {"soil"});
  expect_refused(run("prepare four_wheels --out a.world"), 2, {"tracks"});
  expect_refused(run("prepare no_such --out a.world"), 2, {"no_such"});
  expect_refused(run("prepare level_bed --out missing/a.world"), 1, {"missing/a.world"});
  EXPECT_FALSE(std::filesystem::exists(root_ / "a.world"));
}

// The stand-in drives no wheels: there a network stands beside the baselines.
TEST_F(StandIn, ItIsLeftOutBesideWheels) {
  const std::string sessions = std::string(kDataFolder) + "/experiments/sessions/";
  ASSERT_EQ(
      run("record '" + sessions + "v2_a1.ini' --frames 1600 --quiet --no-pictures --out wheels")
          .exit_code,
      0);
  const Result result = run("nn rollout wheels --drive tracks --model '" +
                            (data_folders().models / "v2.json").string() + "'");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.find("stand-in"), std::string::npos) << result.out;
  for (const char* name : {"no slip", "centres and slope", "v2 ", "v2, floating"}) {
    EXPECT_NE(result.out.find(name), std::string::npos) << name << "\n" << result.out;
  }
  expect_refused(run("nn rollout wheels " + recorded("c_viper_straight")), 2,
                 {"[vehicle] tracks", "wheels"});
}

TEST_F(StandIn, ADriveThatCannotBeFollowedIsRefusedInOneLine) {
  const Result result = run("nn ground nowhere");
  EXPECT_NE(result.exit_code, 0);
  EXPECT_NE(result.err.find("nowhere"), std::string::npos) << result.err;
  EXPECT_EQ(result.out.find("of 0 sessions"), std::string::npos);
}

}  // namespace
}  // namespace screed::testing
