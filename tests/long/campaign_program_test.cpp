// `screed campaign` as a user meets it: the same bytes whatever happens in between, and one clear
// line for whatever goes wrong.
// Long: campaigns are killed, hang and go on, each time with whole runs in worker processes.
#include <sched.h>
#include <signal.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "host_sim/engine/result_store.h"
#include "tests/sitl/background.h"
#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

namespace fs = std::filesystem;

class Campaign : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("flat.ini", "[map]\nmodel = rigid\nsize = 1\n[experiment]\nduration = 0.3\n");
  }

  /// Writes study.ini, a campaign of flat.ini.
  void write_campaign(const std::string& text) const {
    write("study.ini", "[campaign]\nexperiment = flat.ini\n" + text);
  }
  Json run_json(const std::string& arguments, int exit_code = 0) const {
    const Result result = run("campaign " + arguments + " --json");
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    return Json::parse_or_null(result.out);
  }
  /// All bytes of the merged files.
  std::string merged(const std::string& folder) const {
    const Result result = run("campaign merge " + folder);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const fs::path path = root_ / folder;
    return read(path / "runs.csv") + read(path / "curves.csv") + read(path / "campaign.h5");
  }
  /// Lines in the result files.
  size_t results(const std::string& folder) const {
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

constexpr const char* kGrid =
    "seeds = 1..5\nkeep = curves\n[grid]\nexperiment.algorithm = random_walk, hill_sensing\n"
    "vehicle.h = 0, 90\n";

TEST_F(Campaign, PlanSaysWhatWouldRun) {
  write_campaign(kGrid);
  const Json plan = run_json("plan study.ini");
  EXPECT_EQ(plan["name"], "study");
  EXPECT_EQ(plan["cells"], 4);
  EXPECT_EQ(plan["runs"], 20);
  EXPECT_EQ(plan["factors"][1]["values"], Json({"0", "90"}));
  EXPECT_NEAR(plan["simulated_hours"].get<double>(), 20 * 0.3 / 3600.0, 1e-12);
  EXPECT_GT(plan["core_hours"].get<double>(), 0.0);
  EXPECT_GT(plan["memory_mb"].get<double>(), 1.0);
  EXPECT_FALSE(fs::exists(root_ / "out"));
  EXPECT_FALSE(run_json("plan study.ini --no-trial").contains("core_hours"));
}

TEST_F(Campaign, PrintsItsKeys) {
  const std::string keys = run("campaign plan --keys").out;
  EXPECT_GT(lines(keys), 8U);
  for (const char* key : {"| [campaign] experiment |", "| [campaign] seeds |", "count |"})
    EXPECT_NE(keys.find(key), std::string::npos) << keys;
}

TEST_F(Campaign, GivesTheSameBytesWithAnyNumberOfWorkers) {
  write_campaign(kGrid);
  const Json one = run_json("run study.ini --out one --workers 1");
  EXPECT_EQ(one["done"], 20);
  EXPECT_EQ(one["done_now"], 20);
  EXPECT_EQ(run_json("run study.ini --out three --workers 3")["workers"], 3);
  const std::string bytes = merged("one");
  EXPECT_EQ(merged("three"), bytes);
  const std::string csv = read(root_ / "one" / "runs.csv");
  EXPECT_EQ(lines(csv), 21U);
  for (const char* column : {"run,id,cell,seed,status,error,experiment.algorithm,vehicle.h,",
                             ",content_hash,", ",terrain_after.relief_m,", "leveling.progress"})
    EXPECT_NE(csv.find(column), std::string::npos) << column;
  // Two points of the curve of each run: start and end.
  EXPECT_EQ(lines(read(root_ / "one" / "curves.csv")), 41U);
  EXPECT_EQ(lines(read(root_ / "one" / "provenance.csv")), 21U);
}

TEST_F(Campaign, RunsAreThoseOfSim) {
  write_campaign("seeds = 3\n[grid]\nvehicle.h = 90\n");
  run_json("run study.ini");
  ASSERT_EQ(run("campaign merge out/study").exit_code, 0);
  const Json sim = Json::parse(run("sim flat.ini --no-pictures --set experiment.name=study --seed "
                                   "3 --set parameters.random_seed=3 "
                                   "--set vehicle.h=90 --json --out run")
                                   .out);
  EXPECT_NE(read(root_ / "out/study/runs.csv").find(sim["content_hash"].get<std::string>()),
            std::string::npos);
}

TEST_F(Campaign, FinishedRunsAreNotRunAgain) {
  write_campaign("seeds = 1..3\n");
  run_json("run study.ini");
  EXPECT_EQ(run_json("run study.ini")["done_now"], 0);
  EXPECT_EQ(run_json("run out/study")["done_now"], 0);
  // A changed campaign runs what is new in it.
  write_campaign("seeds = 2..5\n");
  const Json more = run_json("run study.ini");
  EXPECT_EQ(more["done_now"], 2);
  EXPECT_EQ(more["done"], 4);
  EXPECT_NE(run("campaign status out/study").err.find("1 results are of other values"),
            std::string::npos);
}

TEST_F(Campaign, KeepsWholeSessions) {
  write_campaign("seeds = 1..2\nkeep = session\n");
  run_json("run study.ini");
  std::set<std::string> files;
  for (const auto& entry : fs::directory_iterator(root_ / "out/study/runs")) {
    EXPECT_EQ(run("replay '" + entry.path().string() + "'").exit_code, 0);
    files.insert(entry.path().filename());
  }
  ASSERT_EQ(files.size(), 2U);
  merged("out/study");
  for (const std::string& id : files)
    EXPECT_NE(read(root_ / "out/study/runs.csv").find(id), std::string::npos);
}

TEST_F(Campaign, KilledAndResumedGivesTheSameBytes) {
  write_campaign("seeds = 1..50\n[grid]\nvehicle.h = 0, 30, 60, 90\n");
  ASSERT_EQ(run("campaign run study.ini --quiet --out whole").exit_code, 0);
  const std::string bytes = merged("whole");

  constexpr size_t kRuns = 200;
  constexpr size_t kKills = 20;
  size_t kills = 0;
  for (int start = 0; kills < kKills && start < 100; ++start) {
    Background program(program_, {"campaign", "run", "study.ini", "--quiet", "--workers", "2"},
                       root_, log("background"));
    // Workers of the first start, then all in turn; each time a few runs further on.
    for (; kills < kKills; ++kills) {
      const size_t goal = std::min((kills + 1) * kRuns / (kKills + 1), kRuns - 1);
      if (!wait_until(program, [&] { return results("out/study") >= goal; })) break;
      const std::vector<pid_t> workers = program.workers();
      if (kills % 2 == 0 || workers.empty()) {
        program.signal(SIGKILL);
        ++kills;
        break;
      }
      ::kill(workers[kills / 2 % workers.size()], SIGKILL);
    }
    program.wait();
  }
  EXPECT_EQ(kills, kKills);
  ASSERT_EQ(run("campaign run study.ini --quiet").exit_code, 0);
  EXPECT_EQ(merged("out/study"), bytes);
}

TEST_F(Campaign, GoesOnAfterCtrlC) {
  write_campaign("seeds = 1..100\n[set]\nexperiment.duration = 2\n");
  Background program(program_, {"campaign", "run", "study.ini", "--quiet"}, root_,
                     log("background"));
  ASSERT_TRUE(wait_until(program, [&] { return results("out/study") >= 2; }));
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 130);
  const std::string said = read(log("background"));
  EXPECT_NE(said.find("the same command goes on"), std::string::npos) << said;
  EXPECT_NE(said.find("of 100 runs done"), std::string::npos) << said;
  const Result refused = run("campaign merge out/study");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(lines(refused.err), 1U) << refused.err;
  EXPECT_NE(refused.err.find("--incomplete"), std::string::npos);
  EXPECT_FALSE(fs::exists(root_ / "out/study/runs.csv"));
  EXPECT_EQ(run_json("run study.ini")["done"], 100);
}

TEST_F(Campaign, AHangingRunCostsOneRun) {
  // Rigid ground takes some 4 ms of the clock a simulated second: a run that ends is far below the
  // limit on a loaded machine too.
  write_campaign(
      "seeds = 1..2\ntime_limit = 4\nmemory = 100\nretries = 0\n"
      "[grid]\nexperiment.duration = 0.3, 100000\n[set]\nmap.edges = walls\n");
  const Result result = run("campaign run study.ini --quiet");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(lines(result.err), 2U) << result.err;
  EXPECT_NE(result.err.find("run 2 did not end within 4 s"), std::string::npos) << result.err;
  EXPECT_NE(result.out.find("2 of 4 runs done, 2 failed"), std::string::npos) << result.out;
  const Json status = run_json("status out/study");
  EXPECT_EQ(status["failures"][0]["run"], 2);
  EXPECT_EQ(run("campaign merge out/study").exit_code, 2);
  ASSERT_EQ(run("campaign merge out/study --incomplete").exit_code, 0);
  EXPECT_NE(read(root_ / "out/study/runs.csv").find(",failed,did not end within 4 s,"),
            std::string::npos);
}

TEST_F(Campaign, ACrashCostsOneRun) {
  // The first run takes long enough to be met.
  write_campaign(
      "seeds = 1\ntime_limit = 600\nmemory = 100\nretries = 0\n"
      "[grid]\nexperiment.duration = 200, 0.3, 0.4\n[set]\nmap.edges = walls\n");
  Background program(program_, {"campaign", "run", "study.ini", "--quiet", "--workers", "1"}, root_,
                     log("background"));
  const std::vector<pid_t> workers = wait_for_workers(program);
  ASSERT_FALSE(workers.empty());
  ::kill(workers.front(), SIGSEGV);
  EXPECT_EQ(program.wait(), 1);
  const std::string said = read(log("background"));
  EXPECT_NE(said.find("run 0 its worker ended by signal 11"), std::string::npos) << said;
  EXPECT_NE(said.find("2 of 3 runs done, 1 failed"), std::string::npos) << said;
  EXPECT_EQ(run_json("run study.ini")["done"], 3);
}

TEST_F(Campaign, ACrashedRunIsTriedAgain) {
  write_campaign(
      "seeds = 1\ntime_limit = 600\nmemory = 100\n[set]\nexperiment.duration = 200\n"
      "map.edges = walls\n");
  Background program(program_, {"campaign", "run", "study.ini", "--quiet"}, root_,
                     log("background"));
  const std::vector<pid_t> workers = wait_for_workers(program);
  ASSERT_FALSE(workers.empty());
  ::kill(workers.front(), SIGKILL);
  EXPECT_EQ(program.wait(), 0);
  ASSERT_EQ(run("campaign merge out/study").exit_code, 0);
  const std::string provenance = read(root_ / "out/study/provenance.csv");
  EXPECT_NE(provenance.find("failures,version"), std::string::npos) << provenance;
  EXPECT_NE(provenance.find(",done,1,"), std::string::npos) << provenance;
}

TEST_F(Campaign, ARunThatCannotBeExecutedIsNamed) {
  write_campaign("seeds = 1\n[grid]\nvehicle.x = 0, 0.49\n[set]\nmap.edges = walls\n");
  const Result result = run("campaign run study.ini --quiet");
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_EQ(lines(result.err), 1U) << result.err;
  EXPECT_NE(result.err.find("run 1 "), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("wall"), std::string::npos) << result.err;
  EXPECT_EQ(run_json("status out/study")["done"], 1);
}

TEST_F(Campaign, ADamagedResultIsRunAgain) {
  write_campaign("seeds = 1..6\n");
  run_json("run study.ini --workers 1");
  const std::string bytes = merged("out/study");
  const fs::path file = result_files("out/study").front();
  std::string text = read(file);
  char& byte = text[text.find('\n') + 60];  // in the second line
  byte = static_cast<char>(byte ^ 1);
  write_text(file, text);
  const Result status = run("campaign status out/study");
  EXPECT_NE(status.out.find("5 of 6 runs done, 1 missing"), std::string::npos) << status.out;
  EXPECT_EQ(lines(status.err), 1U) << status.err;
  EXPECT_NE(status.err.find(file.filename().string() + ":"), std::string::npos) << status.err;
  EXPECT_EQ(run_json("run study.ini")["done_now"], 1);
  const Result merge = run("campaign merge out/study");
  EXPECT_EQ(merge.exit_code, 0);
  EXPECT_EQ(read(root_ / "out/study/runs.csv") + read(root_ / "out/study/curves.csv") +
                read(root_ / "out/study/campaign.h5"),
            bytes);
}

TEST_F(Campaign, RunsOfTwoArithmeticsAreNamed) {
  write_campaign("seeds = 1..2\n");
  run_json("run study.ini --workers 1");
  EXPECT_EQ(run("campaign merge out/study").err, "");
  const fs::path folder = root_ / "out/study/results";
  std::vector<StoredResult> results;
  const ResultIndex index(folder);
  for (const auto& [id, place] : index.places()) results.push_back(index.read(id));
  fs::remove_all(folder);
  std::string& provenance = results.front().provenance;
  const std::string ours = R"("arithmetic":"portable 1")";
  ASSERT_NE(provenance.find(ours), std::string::npos) << provenance;
  provenance.replace(provenance.find(ours), ours.size(), R"("arithmetic":"other")");
  {
    ResultWriter writer(folder);
    for (const StoredResult& result : results) writer.append(result);
  }
  const Result merge = run("campaign merge out/study");
  EXPECT_EQ(merge.exit_code, 0);
  EXPECT_EQ(lines(merge.err), 1U) << merge.err;
  EXPECT_NE(merge.err.find("1 with 'other', 1 with 'portable 1'"), std::string::npos) << merge.err;
}

TEST_F(Campaign, AFullDiskLosesNothingFinished) {
  write_campaign("seeds = 1..3\n");
  run_json("run study.ini");
  write_campaign("seeds = 1..60\n");
  run_json("plan study.ini --no-trial");
  // Files end at some 30 kB: of a run's own files or of the results.
  const Result full = run("campaign run study.ini --quiet --workers 1", "ulimit -f 30;");
  EXPECT_EQ(full.exit_code, 1);
  EXPECT_NE(full.err.find("screed: "), std::string::npos) << full.err;
  const Json rest = run_json("run study.ini");
  EXPECT_EQ(rest["done"], 60);
  EXPECT_LE(rest["done_now"].get<int>(), 57);
}

TEST_F(Campaign, RefusesATargetThatCannotBeWritten) {
  write_campaign("seeds = 1\n");
  write("taken", "a file");
  for (const char* out : {"taken", "/proc/campaign"}) {
    const Result result = run(std::string("campaign run study.ini --quiet --out ") + out);
    EXPECT_EQ(result.exit_code, 1) << out;
    EXPECT_EQ(lines(result.err), 1U) << result.err;
    EXPECT_NE(result.err.find(out), std::string::npos) << result.err;
  }
}

TEST_F(Campaign, RefusesWhatIsNone) {
  expect_refused(run("campaign run gone.ini"), 2, {"gone.ini", "no such campaign file"});
  fs::create_directory(root_ / "empty");
  expect_refused(run("campaign merge empty"), 2, {"plan.json", "no folder of a campaign"});
  expect_refused(run("campaign status empty"), 2, {"plan.json"});
  expect_refused(run("campaign run empty"), 2, {"plan.json"});
  write_campaign("[grid]\nvehicle.x = 900\n");
  expect_refused(run("campaign run study.ini"), 2, {"study.ini:4", "vehicle.x", "-500..500"});
}

TEST_F(Campaign, OnlyOneRunsInAFolder) {
  write_campaign(
      "seeds = 1\ntime_limit = 600\nmemory = 100\n[set]\nexperiment.duration = 100000\n"
      "map.edges = walls\n");
  Background program(program_, {"campaign", "run", "study.ini", "--quiet"}, root_,
                     log("background"));
  ASSERT_TRUE(wait_until(program, [&] { return !program.workers().empty(); }));
  const Result second = run("campaign run study.ini");
  EXPECT_EQ(second.exit_code, 2);
  EXPECT_NE(second.err.find("another `screed campaign run` works on"), std::string::npos);
  // Its workers end with it, even when it is killed.
  const std::vector<pid_t> workers = program.workers();
  program.signal(SIGKILL);
  program.wait();
  for (const pid_t worker : workers)
    while (::kill(worker, 0) == 0) sched_yield();
}

}  // namespace
}  // namespace screed::testing
