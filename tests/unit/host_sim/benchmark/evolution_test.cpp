// The search for parameters: what it runs on which beds, what it verifies, every complaint.
#include "host_sim/benchmark/evolution.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

constexpr const char* kBenchmark =
    "[benchmark]\nversion = 3\nexperiment = base.ini\ntraining_seeds = 1..9\n"
    "test_seeds = 101..104\n"
    "[size small]\nmap.size = 2\n[bed plain]\nmap.ramp = 2\n[bed steep]\nmap.ramp = 9\n"
    "[soil hard]\nmap.model = rigid\n"
    "[robots one]\nexperiment.duration = 50\n[position fixes]\nfixes.period = 1\n"
    "[entry walk]\nexperiment.algorithm = random_walk\nparameters.walk_speed_max = 200\n"
    "parameters.climb_speed = 90\n"
    "[suite single]\nsize = small\nbed = plain\nsoil = hard\nrobots = one\nposition = fixes\n"
    "[suite both]\nsize = small\nbed = plain, steep\nsoil = hard\nrobots = one\nposition = fixes\n";

constexpr const char* kFile =
    "[evolution]\nentry = walk\npopulation = 6\ngenerations = 25\nseed = 5\nbeds = 1..6\n"
    "beds_a_generation = 2\nduration = 20\nfinalists = 2\nverification_beds = 7, 9\n"
    "[search]\nwalk_speed_max = 100..250\nwalk_yaw_rate_max = 10..90 from 20\n"
    "[coarse]\nphysics.step = 0.002\n";

class EvolutionOf : public ::testing::Test {
 protected:
  EvolutionOf() {
    write_text(folder_.path() / "base.ini", "[map]\nmodel = rigid\n");
    write_text(folder_.path() / "b.ini", kBenchmark);
    benchmark_ = read_benchmark(folder_.path() / "b.ini");
  }

  static EvolutionFile file_with(const std::string& old, const std::string& text) {
    std::string all = kFile;
    all.replace(all.find(old), old.size(), text);
    return read_evolution_text(all, "e.ini");
  }
  static std::string refusal(const std::string& old, const std::string& text) {
    try {
      file_with(old, text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  std::string refusal_of(const EvolutionFile& file) const {
    try {
      evolve(file, benchmark_,
             [](const Benchmark&, const EvolutionTask&) { return std::vector<EntryScore>{}; });
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  /// In place of the campaigns: relief is the lower the nearer the parameters are to (150, 70), and
  /// a tenth of that differs from bed to bed. What is asked for is written down.
  std::vector<EntryScore> run(const Benchmark& benchmark, const EvolutionTask& task) {
    tasks_.push_back(task);
    std::vector<EntryScore> scores;
    for (const std::string& name : task.entries) {
      double speed = 0.0;
      double rate = 40.0;  // as the robot has it
      for (const IniEntry& entry : benchmark.levels.at(kEntryFactor).at(name)) {
        if (entry.key == "walk_speed_max") speed = std::stod(entry.value);
        if (entry.key == "walk_yaw_rate_max") rate = std::stod(entry.value);
        if (entry.key == "climb_speed") {
          EXPECT_EQ(entry.value, "90") << "the entry's own stay";
        }
      }
      double relief = -0.5 + std::pow((speed - 150) / 150, 2) + std::pow((rate - 70) / 80, 2);
      relief += 0.1 * std::sin(0.7 * static_cast<double>(task.beds.front()));
      EntryScore score;
      score.entry = name;
      score.runs = task.beds.size();
      score.level_change.mean = relief;
      score.progress.mean = -relief;
      scores.push_back(score);
    }
    return scores;
  }
  Evolution evolved(const EvolutionFile& file) {
    return evolve(file, benchmark_, [this](const Benchmark& benchmark, const EvolutionTask& task) {
      return run(benchmark, task);
    });
  }

  const TempFolder folder_;
  Benchmark benchmark_;
  std::vector<EvolutionTask> tasks_;
};

TEST_F(EvolutionOf, FindsTheBestParametersAndVerifiesThemOnOtherBeds) {
  const EvolutionFile file = read_evolution_text(kFile, "e.ini");
  const Evolution evolution = evolved(file);
  ASSERT_EQ(evolution.archive.size(), 150U);
  EXPECT_EQ(evolution.archive[7].name, "g2c2");
  ASSERT_EQ(evolution.fine.size(), 3U);
  EXPECT_EQ(evolution.fine[0].name, "walk");
  EXPECT_NE(evolution.fine[1].values, evolution.fine[2].values);
  ASSERT_TRUE(evolution.best.has_value());
  const std::vector<std::int16_t>& best = evolution.fine[*evolution.best].values;
  EXPECT_NEAR(best[0], 150, 15);
  EXPECT_NEAR(best[1], 70, 8);

  ASSERT_EQ(tasks_.size(), 27U);
  std::set<std::uint64_t> seen;
  for (std::size_t i = 0; i < 25; ++i) {
    EXPECT_TRUE(tasks_[i].coarse);
    EXPECT_EQ(tasks_[i].beds.size(), 2U);
    seen.insert(tasks_[i].beds.begin(), tasks_[i].beds.end());
  }
  EXPECT_NE(tasks_[0].beds, tasks_[1].beds);
  EXPECT_EQ(seen, (std::set<std::uint64_t>{1, 2, 3, 4, 5, 6}));
  for (const std::size_t i : {25U, 26U})
    EXPECT_EQ(tasks_[i].beds, (std::vector<std::uint64_t>{7, 9}));
  EXPECT_FALSE(tasks_[25].coarse);
  EXPECT_TRUE(tasks_[26].coarse);
  EXPECT_EQ(tasks_[25].against, "walk");

  const std::string entry = entry_text(file, benchmark_, evolution.fine[*evolution.best]);
  EXPECT_NE(entry.find("[experiment]\nalgorithm = random_walk\n\n[parameters]\nclimb_speed = 90\n"
                       "walk_speed_max = " +
                       std::to_string(best[0]) + "\n"),
            std::string::npos)
      << entry;
  const std::string csv = archive_csv(file, evolution);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 151);
  EXPECT_EQ(csv.substr(0, csv.find('\n')),
            "candidate,walk_speed_max,walk_yaw_rate_max,runs,failed,ended_early,level_change,"
            "progress,energy_j");

  tasks_.clear();
  EXPECT_EQ(archive_csv(file, evolved(file)), csv) << "the same search, the same archive";
}

// Beds differ more than candidates do: the first generation has by far the easiest ones here.
TEST_F(EvolutionOf, EasyBedsMakeNoFinalist) {
  const EvolutionFile file = read_evolution_text(kFile, "e.ini");
  const Evolution evolution =
      evolve(file, benchmark_, [this](const Benchmark& benchmark, const EvolutionTask& task) {
        std::vector<EntryScore> scores = run(benchmark, task);
        if (task.name == "generation-01")
          for (EntryScore& score : scores) score.level_change.mean -= 5.0;
        return scores;
      });
  ASSERT_EQ(evolution.fine.size(), 3U);
  EXPECT_EQ(evolution.fine[1].name, "middle");
  EXPECT_NEAR(evolution.fine[1].values[0], 150, 15);
  EXPECT_NEAR(evolution.fine[1].values[1], 70, 8);
  EXPECT_EQ(evolution.fine[2].name.substr(0, 4), "g25c");
}

TEST_F(EvolutionOf, SaysSoWhereNothingFoundIsBetter) {
  // From where it is best, in steps that lead away.
  EvolutionFile file = read_evolution_text(
      "[evolution]\nentry = walk\npopulation = 5\ngenerations = 1\nbeds = 1\n"
      "beds_a_generation = 1\nverification_beds = 2\n"
      "[search]\nwalk_yaw_rate_max = 70..90 from 90\n",
      "e.ini");
  benchmark_.levels[kEntryFactor]["walk"] = {{"experiment", "algorithm", "random_walk", 0},
                                             {"parameters", "climb_speed", "90", 0},
                                             {"parameters", "walk_yaw_rate_max", "70", 0},
                                             {"parameters", "walk_speed_max", "150", 0}};
  EXPECT_FALSE(evolved(file).best.has_value());
}

TEST_F(EvolutionOf, AFailedRunIsWorthNothing) {
  EntryScore score;
  score.level_change.mean = -0.4;
  score.progress.mean = 0.2;
  EXPECT_EQ(value_of(score, EvolutionObjective::kLevel), -0.4);
  EXPECT_EQ(value_of(score, EvolutionObjective::kProgress), -0.2);
  score.failed = 1;
  EXPECT_EQ(value_of(score, EvolutionObjective::kLevel), 1.0);
  score = {};
  EXPECT_EQ(value_of(score, EvolutionObjective::kLevel), 1.0) << "no figure";
}

TEST_F(EvolutionOf, TheSearchsRunsAreShorterAndCoarser) {
  const EvolutionFile file = read_evolution_text(kFile, "e.ini");
  EvolutionTask task{"generation-01", "", {"walk"}, {4, 2}, true};
  const CampaignFile coarse = evolution_campaign(file, benchmark_, task);
  EXPECT_EQ(coarse.settings.seeds, (std::vector<std::uint64_t>{4, 2}));
  ASSERT_EQ(coarse.fixed.size(), 1U);
  EXPECT_EQ(coarse.fixed[0].keys[0].text(), "physics.step");
  EXPECT_EQ(make_plan(coarse, "1").durations_s, std::vector<double>{20.0});
  task.coarse = false;
  const CampaignFile fine = evolution_campaign(file, benchmark_, task);
  EXPECT_TRUE(fine.fixed.empty());
  EXPECT_EQ(make_plan(fine, "1").durations_s, std::vector<double>{50.0});
}

// The shipped search begins at what the robot has, and every campaign of it can be planned.
TEST_F(EvolutionOf, TheShippedSearchFitsTheBenchmark) {
  const EvolutionFile file = read_evolution_file("host_sim/data/evolution/strokes.ini");
  const Benchmark leveling = read_benchmark(benchmark_path());
  std::size_t planned = 0;
  const Evolution evolution =
      evolve(file, leveling, [&](const Benchmark& benchmark, const EvolutionTask& task) {
        const CampaignPlan plan = make_plan(evolution_campaign(file, benchmark, task), "1");
        EXPECT_EQ(plan.run_count(), task.entries.size() * task.beds.size());
        EXPECT_EQ(plan.durations_s.front(), task.coarse ? 1800.0 : 5400.0);
        ++planned;
        std::vector<EntryScore> scores(task.entries.size());
        for (std::size_t i = 0; i < scores.size(); ++i) {
          scores[i].entry = task.entries[i];
          scores[i].level_change.mean = -0.1;
          scores[i].progress.mean = 0.1;
        }
        return scores;
      });
  EXPECT_EQ(planned, file.generations + 2);
  EXPECT_FALSE(evolution.best.has_value()) << "all the same";
}

TEST_F(EvolutionOf, EveryMistakeIsNamed) {
  EXPECT_EQ(refusal("population = 6", "population = 4"),
            "e.ini:3: [evolution] population = '4' is not allowed; expected a number from 5 to "
            "1000");
  EXPECT_EQ(refusal("seed = 5", "sed = 5").find("e.ini:5: [evolution] sed: unknown key; known are"),
            0U);
  EXPECT_EQ(refusal("[coarse]", "[course]"),
            "e.ini:15: [course] physics.step: unknown section; known are [evolution], [search] and "
            "[coarse]");
  EXPECT_EQ(refusal("entry = walk\n", ""), "e.ini: has no [evolution] entry");
  EXPECT_EQ(refusal("= 7, 9", "= 6, 9"),
            "e.ini: bed 6 is one of beds and of verification_beds; what was searched on verifies "
            "nothing");
  EXPECT_EQ(refusal("beds_a_generation = 2", "beds_a_generation = 7"),
            "e.ini: beds_a_generation: there are only 6 beds");
  EXPECT_EQ(refusal("walk_speed_max = 100", "walk_sped = 100"),
            "e.ini:12: [search] walk_sped: is no parameter of the robot (screed sim --keys lists "
            "them)");
  for (const char* range : {"100..251", "100", "200..100", "100..x", "100..250 from x"}) {
    EXPECT_EQ(refusal("100..250", range),
              "e.ini:12: [search] walk_speed_max = '" + std::string(range) +
                  "' is not allowed; expected LOW..HIGH or LOW..HIGH from START, within 0 to 250");
  }
  EXPECT_EQ(refusal("100..250", "100..150"),
            "e.ini:12: [search] walk_speed_max: begins at 160, which is not in the range; expected "
            "another range, or one with from");
  EXPECT_EQ(refusal("physics.step", "physics.stop").find("e.ini:15: [coarse] physics.stop"), 0U);

  EXPECT_EQ(refusal_of(file_with("entry = walk", "entry = run")),
            "e.ini: the benchmark has no entry 'run'; known are walk, hill_sensing, spin_on_peak, "
            "coverage, peak_memory, strokes");
  EXPECT_EQ(refusal_of(file_with("entry = walk", "suite = none\nentry = walk")),
            "e.ini: the benchmark has no suite 'none'");
  EXPECT_EQ(refusal_of(file_with("entry = walk", "suite = both\nentry = walk")),
            "e.ini: the suite 'both' has several courses; expected one with one bed");
  EXPECT_EQ(refusal_of(file_with("= 7, 9", "= 7, 101")),
            "e.ini: 101 is no training bed of the benchmark");
}

}  // namespace
}  // namespace screed
