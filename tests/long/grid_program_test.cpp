// `screed grid` as a user meets it: single runs, and sweeps with workers that come and go.
// Long: sweeps are killed and go on, with workers in processes of their own.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "tests/sitl/background.h"
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
  const auto json = Json::parse(run_.out);
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
  const auto first = Json::parse(recorded.out);
  const auto second = Json::parse(replayed.out);
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

// ---- sweeps ------------------------------------------------------------------------------------

namespace fs = std::filesystem;

class GridSweep : public Program {
 protected:
  /// Lines in the result files of a sweep's folder.
  size_t stored(const std::string& folder) const {
    size_t lines = 0;
    for (const fs::path& file : result_files(folder)) {
      const std::string text = read(file);
      lines += static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
    }
    return lines;
  }
  std::vector<fs::path> result_files(const std::string& folder) const {
    std::vector<fs::path> files;
    std::error_code ignored;
    for (const auto& entry : fs::directory_iterator(root_ / folder / "results", ignored))
      files.push_back(entry.path());
    return files;
  }
  static size_t lines(const std::string& text) {
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
  }
};

TEST_F(GridSweep, GivesTheSameBytesWithAnyNumberOfWorkers) {
  ASSERT_EQ(run(small("--runs 40 --workers 1 --out one")).exit_code, 0);
  const Result two = run(small("--runs 40 --workers 2 --out two"));
  ASSERT_EQ(two.exit_code, 0) << two.err;
  EXPECT_EQ(two.err, "");
  const std::string table = read(root_ / "one/runs.csv");
  EXPECT_EQ(lines(table), 42U);
  EXPECT_EQ(read(root_ / "two/runs.csv"), table);
  // --threads is its former name; without a folder the figures are the same and nothing is kept.
  const Result unkept = run(small("--runs 40 --threads 3"));
  EXPECT_EQ(unkept.out, two.out);
  EXPECT_FALSE(fs::exists(root_ / "results"));
  // Each run is the one of its seed alone.
  const auto alone = Json::parse(
      run("grid --headless --size 12 --lattice 5 --mean 4 --agents 4 --seed 5 --json").out);
  EXPECT_NE(table.find("\n0,2,5,1," + std::to_string(alone["cycles"].get<int>()) + "," +
                       std::to_string(alone["units"].get<int>()) + ","),
            std::string::npos)
      << table;
}

/// Tables of former versions stay what they are.
TEST_F(GridSweep, TableHasItsForm) {
  ASSERT_EQ(
      run("grid --size 8 --agents 4 --algorithm forager --runs 3 --quiet --out sweep").exit_code,
      0);
  EXPECT_EQ(read(root_ / "sweep/runs.csv"),
            "# screed grid sweep 825f25593032c64d7bcb0d0dbf3d5d83\n"
            "point,run,seed,level,cycles,units,least_units,straight_steps,diagonal_steps\n"
            "0,0,1,1,1265,56,53,2286,1236\n"
            "0,1,2,1,1163,57,52,2079,1214\n"
            "0,2,3,1,910,47,45,1489,1125\n");
}

TEST_F(GridSweep, KilledAndResumedGivesTheSameBytes) {
  const std::vector<std::string> sweep = {"grid",   "--size",  "12",        "--lattice", "5",
                                          "--mean", "4",       "--agents",  "4",         "--runs",
                                          "3000",   "--quiet", "--workers", "2",         "--out"};
  const auto sweep_into = [&](const std::string& folder) {
    std::string text;
    for (const std::string& word : sweep) text += word + " ";
    return run(text + folder);
  };
  ASSERT_EQ(sweep_into("whole").exit_code, 0);

  constexpr size_t kKills = 12;
  size_t kills = 0;
  for (int start = 0; kills < kKills && start < 60; ++start) {
    std::vector<std::string> words = sweep;
    words.emplace_back("killed");
    Background program(program_, words, root_, log("background"));
    // The program and one worker in turns, each time some runs further on.
    for (; kills < kKills; ++kills) {
      const size_t goal = (kills + 1) * 3000 / (kKills + 1);
      if (!wait_until(program, [&] { return stored("killed") >= goal; })) break;
      const std::vector<pid_t> workers = program.workers();
      if (kills % 2 == 0 || workers.empty()) {
        program.signal(SIGKILL);
        ++kills;
        break;
      }
      ::kill(workers.front(), SIGKILL);
    }
    program.wait();
  }
  EXPECT_EQ(kills, kKills);
  const Result rest = sweep_into("killed");
  ASSERT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_NE(rest.err.find(" runs were there already\n"), std::string::npos) << rest.err;
  EXPECT_EQ(read(root_ / "killed/runs.csv"), read(root_ / "whole/runs.csv"));
}

TEST_F(GridSweep, AKilledWorkerCostsNothing) {
  // A run takes long enough to be met.
  Background program(program_,
                     {"grid", "--size", "300", "--max-cycles", "100000", "--runs", "3", "--workers",
                      "1", "--quiet", "--out", "sweep"},
                     root_, log("background"));
  const std::vector<pid_t> workers = wait_for_workers(program);
  ASSERT_FALSE(workers.empty());
  ::kill(workers.front(), SIGKILL);
  EXPECT_EQ(program.wait(), 0) << read(log("background"));
  EXPECT_EQ(stored("sweep"), 4U);  // the failed attempt is one of them
  EXPECT_EQ(lines(read(root_ / "sweep/runs.csv")), 5U);
}

/// Its runs are tried one by one.
TEST_F(GridSweep, AKilledWorkerCostsNoneOfItsBatch) {
  Background program(program_,
                     {"grid", "--size", "12", "--lattice", "5", "--mean", "4", "--agents", "4",
                      "--runs", "2000", "--workers", "1", "--quiet", "--out", "sweep"},
                     root_, log("background"));
  ASSERT_TRUE(wait_until(program, [&] { return stored("sweep") >= 500; }));
  const std::vector<pid_t> workers = wait_for_workers(program);
  ASSERT_FALSE(workers.empty());
  ::kill(workers.front(), SIGKILL);
  EXPECT_EQ(program.wait(), 0) << read(log("background"));
  EXPECT_EQ(lines(read(root_ / "sweep/runs.csv")), 2002U);
}

TEST_F(GridSweep, GoesOnAfterCtrlC) {
  Background program(program_,
                     {"grid", "--size", "100", "--max-cycles", "20000", "--runs", "20000",
                      "--quiet", "--workers", "1", "--out", "sweep"},
                     root_, log("background"));
  ASSERT_TRUE(wait_until(program, [&] { return stored("sweep") >= 2; }));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 130);
  EXPECT_EQ(read(log("background")), "stopped; the same command goes on where it stopped\n");
  EXPECT_FALSE(fs::exists(root_ / "sweep/runs.csv"));
  const Result rest = run("grid --size 100 --max-cycles 20000 --runs 2 --quiet --out sweep");
  EXPECT_EQ(rest.exit_code, 0);
  EXPECT_EQ(rest.err, "note: 2 runs were there already\n");
  EXPECT_GE(lines(read(root_ / "sweep/runs.csv")), 4U);
}

TEST_F(GridSweep, MoreRunsAreAddedToThoseThatAreThere) {
  ASSERT_EQ(run(small("--runs 4 --quiet --out sweep")).exit_code, 0);
  EXPECT_EQ(run(small("--runs 6 --quiet --out sweep")).err, "note: 4 runs were there already\n");
  const std::string six = read(root_ / "sweep/runs.csv");
  EXPECT_EQ(lines(six), 8U);
  // Fewer are read from it without loss.
  EXPECT_EQ(run(small("--runs 2 --quiet --out sweep")).err, "note: 2 runs were there already\n");
  EXPECT_EQ(read(root_ / "sweep/runs.csv"), six);
  EXPECT_EQ(stored("sweep"), 6U);
}

TEST_F(GridSweep, ADamagedResultIsRunAgain) {
  ASSERT_EQ(run(small("--runs 6 --quiet --workers 1 --out sweep")).exit_code, 0);
  const std::string table = read(root_ / "sweep/runs.csv");
  const fs::path file = result_files("sweep").front();
  std::string text = read(file);
  char& byte = text[text.find('\n') + 60];  // in the second line
  byte = static_cast<char>(byte ^ 1);
  write_text(file, text);
  const Result again = run(small("--runs 6 --quiet --out sweep"));
  EXPECT_EQ(again.exit_code, 0);
  EXPECT_NE(again.err.find(file.filename().string() + ":2: the line is damaged"), std::string::npos)
      << again.err;
  EXPECT_NE(again.err.find("note: 5 runs were there already\n"), std::string::npos) << again.err;
  EXPECT_EQ(read(root_ / "sweep/runs.csv"), table);
}

TEST_F(GridSweep, AFullDiskLosesNothingFinished) {
  const Result full = run(small("--runs 2000 --quiet --workers 1 --out sweep"), "ulimit -f 30;");
  expect_refused(full, 1, {"results/", "cannot be written"});
  const size_t kept = stored("sweep");
  EXPECT_GT(kept, 10U);
  const Result rest = run(small("--runs 2000 --quiet --out sweep"));
  EXPECT_EQ(rest.exit_code, 0) << rest.err;
  EXPECT_EQ(rest.err, "note: " + std::to_string(kept) + " runs were there already\n");
}

TEST_F(GridSweep, RefusesInOneLine) {
  expect_refused(run(small("--runs 0")), 2, {"--runs 0", "allowed"});
  expect_refused(run(small("--runs 2 --workers -1")), 2, {"--workers -1", "allowed"});
  expect_refused(run("grid --terrain gone.png --runs 2 --out sweep"), 2, {"gone.png"});
  expect_refused(run("grid --size 12 --agents 145 --runs 2 --out sweep"), 2,
                 {"agents = 145", "144"});
  expect_refused(run(small("--runs 2 --record run.h5")), 2, {"--record", "single run"});
  EXPECT_FALSE(fs::exists(root_ / "sweep"));
  expect_refused(run("grid --figure 4.1"), 2, {"figure = 4.1", "better"});
  ASSERT_EQ(run(small("--runs 2 --quiet --out sweep")).exit_code, 0);
  expect_refused(run("grid --size 12 --runs 2 --out sweep"), 2,
                 {"sweep/runs.csv", "another sweep"});
  write("taken", "a file");
  expect_refused(run(small("--runs 2 --out taken")), 1, {"taken", "cannot be made"});
}

TEST_F(GridSweep, OnlyOneRunsInAFolder) {
  Background program(program_,
                     {"grid", "--size", "300", "--max-cycles", "1000000000", "--runs", "1",
                      "--quiet", "--out", "sweep"},
                     root_, log("background"));
  ASSERT_TRUE(wait_until(program, [&] { return !program.workers().empty(); }));
  expect_refused(run("grid --size 300 --max-cycles 1000000000 --runs 1 --out sweep"), 2,
                 {"sweep", "another sweep"});
  // Its workers end with it, even when it is killed.
  const std::vector<pid_t> workers = program.workers();
  program.signal(SIGKILL);
  program.wait();
  for (const pid_t worker : workers)
    while (::kill(worker, 0) == 0) sched_yield();
}

TEST_F(GridSweep, FiguresShareTheirRuns) {
  const std::string base = "--size 8 --lattice 5 --agents 4 --runs 2 --quiet --out figures";
  const Result first = run("grid --figure 4.4 " + base);
  ASSERT_EQ(first.exit_code, 0) << first.err;
  const Result second = run("grid --figure 4.5 " + base);
  EXPECT_EQ(second.err, "note: 6 runs were there already\n");
  for (const char* file : {"figure-4.4-4.5_runs.csv", "figure-4.4.csv", "figure-4.5.svg"})
    EXPECT_TRUE(fs::exists(root_ / "figures" / file)) << file;
  EXPECT_NE(second.out.find("figures/figure-4.4-4.5_runs.csv"), std::string::npos) << second.out;
}

}  // namespace
}  // namespace screed::testing
