// The leveling benchmark's file: what it runs, what strangers may add, every complaint.
#include "host_sim/benchmark/benchmark_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

constexpr const char* kSmall =
    "[benchmark]\nversion = 3\nexperiment = base.ini\ntraining_seeds = 1..9\n"
    "test_seeds = 101..104\n"
    "[size small]\nmap.size = 2\n[bed plain]\nmap.ramp = 2\n[soil hard]\nmap.model = rigid\n"
    "[robots one]\nexperiment.duration = 50\n[position fixes]\nfixes.period = 1\n"
    "[entry walk]\nexperiment.algorithm = random_walk\n"
    "[suite all]\nsize = small\nbed = plain\nsoil = hard\nrobots = one\nposition = fixes\nseeds = "
    "2\n"
    "[suite short]\nsize = small\nbed = plain\nsoil = hard\nrobots = one\nposition = fixes\nentry "
    "= walk\n"
    "duration = 5\n";

class BenchmarkFile : public ::testing::Test {
 protected:
  Benchmark read(const std::string& text) const {
    write_text(folder_.path() / "base.ini", "[map]\nmodel = rigid\n");
    write_text(folder_.path() / "b.ini", text);
    return read_benchmark(folder_.path() / "b.ini");
  }
  template <class Action>
  static std::string refusal(Action action) {
    try {
      action();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  const TempFolder folder_;
};

TEST_F(BenchmarkFile, RunsEveryCourseWithEachEntryOnTheTestBeds) {
  const Benchmark benchmark = read(kSmall);
  EXPECT_EQ(benchmark.version, 3);
  const CampaignPlan plan = make_plan(benchmark_campaign(benchmark, {.suite = "all"}), "1");
  EXPECT_EQ(plan.settings.seeds, (std::vector<std::uint64_t>{101, 102}));
  std::set<std::string> algorithms;
  for (std::size_t cell = 0; cell < plan.cells.size(); ++cell) {
    const Experiment experiment = resolve_run(plan, cell * 2).experiment;
    EXPECT_EQ(experiment.map.size_m, 2.0);
    EXPECT_EQ(experiment.experiment.duration_s, 50.0);
    algorithms.insert(experiment.experiment.algorithm);
  }
  // What the file does not name is there by itself; what levels nothing is not.
  EXPECT_TRUE(algorithms.contains("spin_on_peak"));
  EXPECT_TRUE(algorithms.contains("coverage"));
  EXPECT_FALSE(algorithms.contains("training_drive"));
  EXPECT_EQ(plan.cells.front().back(), "walk");
}

TEST_F(BenchmarkFile, ASuiteShortensAndTrainingBedsAreOthers) {
  const Benchmark benchmark = read(kSmall);
  const CampaignPlan plan = make_plan(
      benchmark_campaign(benchmark, {.suite = "short", .training = true, .seeds = 4}), "1");
  EXPECT_EQ(plan.settings.seeds, (std::vector<std::uint64_t>{1, 2, 3, 4}));
  EXPECT_EQ(plan.cells.size(), 1U);
  EXPECT_EQ(plan.durations_s, (std::vector<double>{5.0}));
  EXPECT_NE(refusal([&] {
              benchmark_campaign(benchmark, {.suite = "short", .seeds = 5});
            }).find("allowed are 1 to 4"),
            std::string::npos);
}

TEST_F(BenchmarkFile, ASuiteMayNameWhichOfTheTestBedsAreIts) {
  const std::string text = kSmall;
  const Benchmark benchmark = read(text + "test_seeds = 103..104\n");
  const auto seeds = [&](const BenchmarkChoice& choice) {
    return make_plan(benchmark_campaign(benchmark, choice), "1").settings.seeds;
  };
  using Seeds = std::vector<std::uint64_t>;
  EXPECT_EQ(seeds({.suite = "short", .seeds = 2}), (Seeds{103, 104}));
  EXPECT_EQ(seeds({.suite = "all"}), (Seeds{101, 102}));
  EXPECT_EQ(seeds({.suite = "short", .training = true, .seeds = 2}), (Seeds{1, 2}));
  EXPECT_NE(refusal([&] {
              benchmark_campaign(benchmark, {.suite = "short", .seeds = 3});
            }).find("allowed are 1 to 2"),
            std::string::npos);
  EXPECT_NE(refusal([&] { read(text + "test_seeds = 104..105\n"); })
                .find("[suite short] test_seeds = '104..105' is not allowed; expected seeds of "
                      "[benchmark] test_seeds"),
            std::string::npos);
}

TEST_F(BenchmarkFile, AStrangersEntryIsAnExperimentFile) {
  Benchmark benchmark = read(kSmall);
  const auto mine = folder_.path() / "mine.ini";
  write_text(mine, "[experiment]\nalgorithm = spin_on_peak\n[parameters]\nspin_time = 1234\n");
  EXPECT_EQ(add_entry(mine, benchmark), "mine");
  const CampaignPlan plan =
      make_plan(benchmark_campaign(benchmark, {.suite = "short", .entries = {"mine"}}), "1");
  EXPECT_EQ(resolve_run(plan, 0).experiment.parameters.spin_time(), 1234);
  EXPECT_NE(refusal([&] { add_entry(mine, benchmark); }).find("an entry mine already"),
            std::string::npos);

  const auto cheat = folder_.path() / "cheat.ini";
  write_text(cheat, "[experiment]\nalgorithm = spin_on_peak\n[map]\nsize = 1\n");
  EXPECT_NE(refusal([&] { add_entry(cheat, benchmark); }).find("[map] size: is not an entry's"),
            std::string::npos);
  write_text(cheat, "[parameters]\nspin_time = 1\n");
  EXPECT_NE(refusal([&] { add_entry(cheat, benchmark); }).find("no [experiment] algorithm"),
            std::string::npos);
}

TEST_F(BenchmarkFile, ComplaintsNameThePlace) {
  const std::string text = kSmall;
  EXPECT_NE(refusal([&] {
              read(text + "[suite x]\nbed = moon\n");
            }).find("[suite x] bed = 'moon' is not allowed; expected plain"),
            std::string::npos);
  EXPECT_NE(
      refusal([&] { read(text + "[beds x]\nmap.size = 1\n"); }).find("unknown section [beds x]"),
      std::string::npos);
  EXPECT_NE(refusal([&] { read("[benchmark]\nversion = 1\n"); }).find("needs version"),
            std::string::npos);
  const Benchmark benchmark = read(text);
  EXPECT_NE(refusal([&] {
              benchmark_campaign(benchmark, {.suite = "none"});
            }).find("known are all, short"),
            std::string::npos);
  EXPECT_NE(refusal([&] {
              benchmark_campaign(benchmark, {.suite = "short", .entries = {"magic"}});
            }).find("unknown entry 'magic'"),
            std::string::npos);
}

TEST_F(BenchmarkFile, TheShippedOneResolvesEverySuite) {
  const Benchmark benchmark = read_benchmark(benchmark_path());
  for (const auto& [name, suite] : benchmark.suites) {
    const CampaignPlan plan =
        make_plan(benchmark_campaign(benchmark, {.suite = name, .seeds = 1}), "1");
    EXPECT_GT(plan.run_count(), 0U) << name;
  }
  const std::set<std::uint64_t> training(benchmark.training_seeds.begin(),
                                         benchmark.training_seeds.end());
  for (const std::uint64_t seed : benchmark.test_seeds) EXPECT_FALSE(training.contains(seed));
}

// What `make level` shows is what the benchmark scores.
TEST(ShippedBenchmark, LevelBedIsARunOfStrokesOnItsFirstTrainingBed) {
  BenchmarkChoice choice;
  choice.suite = "single";
  choice.training = true;
  choice.entries = {"strokes"};
  choice.seeds = 1;
  const CampaignPlan plan =
      make_plan(benchmark_campaign(read_benchmark(benchmark_path()), choice), "1");
  Experiment scored = resolve_run(plan, 0).experiment;
  scored.experiment.name = "level_bed";
  Experiment shown = read_experiment(find_experiment("level_bed"));
  EXPECT_EQ(scored.text(), shown.text());
}

}  // namespace
}  // namespace screed
