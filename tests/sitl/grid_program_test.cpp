// `screed grid` as a user meets it.
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/sitl/program.h"
#include "tests/sitl/terminal.h"

namespace screed::testing {
namespace {

// Small enough to be level within a second, under the sanitizers too.
constexpr const char* kSmall = "grid --headless --size 12 --lattice 5 --mean 4 --agents 4 --seed 3";

std::string small(const std::string& more) {
  return std::string(kSmall) + " " + more;
}

TEST_F(Program, GridLevels) {
  const Result run_ = run(small("--algorithm forager --json"));
  ASSERT_EQ(run_.exit_code, 0) << run_.err;
  const auto json = nlohmann::json::parse(run_.out);
  EXPECT_TRUE(json["level"].get<bool>());
  EXPECT_LE(json["highest"].get<int>() - json["lowest"].get<int>(), 1);
  EXPECT_GE(json["units"].get<int>(), json["least_units"].get<int>());
  EXPECT_GT(json["least_units"].get<int>(), 0);
  EXPECT_EQ(run_.err, "");
}

TEST_F(Program, GridShowsATable) {
  const Result table = run(small("--algorithm probabilistic --max-cycles 500000"));
  EXPECT_EQ(table.exit_code, 0) << table.err;
  for (const char* part : {"probabilistic, seed 3", "cycles", "units moved", "fewest possible"}) {
    EXPECT_NE(table.out.find(part), std::string::npos) << part << " in: " << table.out;
  }
}

TEST_F(Program, GridShowsHowMuchIsLeveledAndStops) {
  Terminal terminal({program_, "grid", "--headless", "--size", "300", "--agents", "20",
                     "--max-cycles", "1000000000"},
                    root_);
  ASSERT_TRUE(terminal.wait_for("leveled, cycle ")) << terminal.screen();
  terminal.signal(SIGINT);
  EXPECT_EQ(terminal.exit_code(), 130) << terminal.screen();
  EXPECT_NE(terminal.screen().find("not level"), std::string::npos) << terminal.screen();
}

TEST_F(Program, GridRefusesBadInputInOneLine) {
  struct Case {
    const char* arguments;
    std::vector<std::string> parts;  // of the message: what, and what is allowed
  };
  const std::vector<Case> cases = {
      {"--algorithm magic", {"magic", "probabilistic", "forager"}},
      {"--probability 1.5", {"--probability 1.5", "0 to 1"}},
      {"--p-pick-up -0.1", {"--p-pick-up -0.1", "0 to 1"}},
      {"--p-deposit 2", {"--p-deposit 2", "0 to 1"}},
      {"--p-sense nan", {"--p-sense nan", "0 to 1"}},
      {"--p-turn -1", {"--p-turn -1", "0 to 1"}},
      {"--algorithm threshold -k 0", {"-k 0", "allowed"}},
      {"--algorithm threshold -k -3", {"-k -3", "allowed"}},
      {"--agents 145", {"agents = 145", "144"}},
      {"--agents 0", {"--agents 0", "allowed"}},
      {"--size 0", {"size", "0", "allowed"}},
      {"--size 12x0", {"size", "0", "allowed"}},
      {"--size -4", {"size", "-4", "allowed"}},
      {"--size wide", {"size = wide", "WIDTHxHEIGHT"}},
      {"--size ''", {"size = ", "WIDTHxHEIGHT"}},
      {"--size nan", {"size = nan", "WIDTHxHEIGHT"}},
      {"--size 12xinf", {"size = 12xinf", "WIDTHxHEIGHT"}},
      {"--size 99999999999", {"size = 99999999999", "WIDTHxHEIGHT"}},
      {"--seed -1", {"--seed -1", "allowed"}},
      {"--max-cycles 0", {"--max-cycles 0", "allowed"}},
      {"--stop never", {"stop = never", "level"}},
      {"--terrain gone.png", {"gone.png"}},
      {"--render picture.bmp", {"picture.bmp", ".png"}},
      {"--replay gone.h5", {"gone.h5"}},
      {"--no-such-option", {"--no-such-option"}},
  };
  for (const Case& bad : cases) {
    SCOPED_TRACE(bad.arguments);
    // The last one counts where an option is given twice.
    std::string arguments = bad.arguments;
    if (arguments.find("--size") == std::string::npos) arguments += " --size 12";
    expect_refused(run("grid --headless --lattice 5 --mean 4 " + arguments), 2, bad.parts);
  }
}

TEST_F(Program, GridRecordsAndReplays) {
  const Result recorded = run(small("--algorithm forager --json --record run.h5"));
  ASSERT_EQ(recorded.exit_code, 0) << recorded.err;
  const Result replayed = run("grid --replay run.h5 --headless --json");
  ASSERT_EQ(replayed.exit_code, 0) << replayed.err;
  const auto first = nlohmann::json::parse(recorded.out);
  const auto second = nlohmann::json::parse(replayed.out);
  EXPECT_TRUE(second["matches"].get<bool>());
  EXPECT_EQ(second["cycles"], first["cycles"]);
  EXPECT_EQ(second["units"], first["units"]);

  const std::string whole = read(root_ / "run.h5");
  expect_refused(run(small("--record run.h5")), 2, {"run.h5", "exists"});
  EXPECT_EQ(read(root_ / "run.h5"), whole);
}

TEST_F(Program, GridReplaysNoHalfARecording) {
  ASSERT_EQ(run(small("--algorithm forager --quiet --record run.h5")).exit_code, 0);
  const std::string whole = read(root_ / "run.h5");
  write("half.h5", whole.substr(0, whole.size() / 2));
  expect_refused(run("grid --replay half.h5 --headless"), 2, {"half.h5"});
}

TEST_F(Program, GridLeavesNothingOnAFullDisk) {
  for (const std::string what : {"--record run.h5", "--curve curve.csv"}) {
    const Result result = run(small("--quiet " + what), "ulimit -f 0;");
    EXPECT_NE(result.exit_code, 0);
    EXPECT_TRUE(std::filesystem::is_empty(root_)) << what;
  }
}

}  // namespace
}  // namespace screed::testing
