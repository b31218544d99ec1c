// `screed level bench [ENTRY...]`: runs the leveling benchmark and prints its table.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "host_sim/benchmark/benchmark_file.h"
#include "host_sim/benchmark/benchmark_score.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "tools/screed/campaign/campaign_work.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

struct BenchArguments {
  std::vector<std::string> entries;
  std::string suite = "core";
  bool quick = false;
  bool training = false;
  bool sessions = false;
  std::string against = "spin_on_peak";
  std::optional<std::uint64_t> seeds;
  std::optional<std::string> file;
  std::optional<std::string> out;
  std::optional<int> workers;
  bool quiet = false;
  bool json = false;
};

Json json_of(const SeedMean& mean) {
  return {{"mean", mean.mean}, {"low", mean.interval.low}, {"high", mean.interval.high}};
}

Json json_of(const EntryScore& score) {
  Json json = {{"entry", score.entry},
               {"runs", score.runs},
               {"failed", score.failed},
               {"ended_early", score.ended_early},
               {"relief_change", json_of(score.relief_change)},
               {"rate_per_h", json_of(score.rate_per_h)},
               {"roughness_change", json_of(score.roughness_change)},
               {"progress", json_of(score.progress)},
               {"energy_j", json_of(score.energy_j)},
               {"transport_per_joule_cm3_m", json_of(score.transport_per_joule)},
               {"stuck", json_of(score.stuck)},
               {"halved", score.halved}};
  if (std::isfinite(score.half_time_s)) json["half_time_s"] = score.half_time_s;
  if (score.against_baseline.has_value()) {
    json["against_baseline"] = {{"difference", json_of(score.against_baseline->difference)},
                                {"p_holm", score.against_baseline->p_holm},
                                {"effect", score.against_baseline->test.effect}};
    if (score.times_baseline.has_value())
      json["against_baseline"]["times"] = json_of(*score.times_baseline);
  }
  return json;
}

/// "15/30, 1.48 h": how many beds came to half of their relief, and when half of them had.
std::string half_text(const EntryScore& score) {
  std::string text = std::to_string(score.halved) + "/" + std::to_string(score.runs + score.failed);
  if (!std::isfinite(score.half_time_s)) return text;
  char time[32];
  std::snprintf(time, sizeof time, ", %.2f h", score.half_time_s / 3600.0);
  return text + time;
}

/// "-12.3 (-15.1 to -9.8)"; of a single bed without an interval.
std::string with_interval(const SeedMean& mean, double factor, int digits) {
  char text[96];
  if (!std::isfinite(mean.interval.low)) {
    std::snprintf(text, sizeof text, "%.*f", digits, factor * mean.mean);
    return text;
  }
  std::snprintf(text, sizeof text, "%.*f (%.*f to %.*f)", digits, factor * mean.mean, digits,
                factor * mean.interval.low, digits, factor * mean.interval.high);
  return text;
}

void print_course(const CourseScore& course, const std::string& against) {
  std::string name;
  for (const std::string& level : course.levels) name += (name.empty() ? "" : ", ") + level;
  std::printf("%s, %.0f s; means over the beds and 95 %% intervals; against %s: Wilcoxon, Holm\n",
              name.c_str(), course.duration_s, against.c_str());
  std::printf("  %-16s %-26s %-26s %-24s %-14s %9s %8s %6s %5s  %s\n", "entry", "relief [%]",
              "progress [%]", "rate [%/h]", "half by", "cm3 m/J", "stuck %", "early", "lost",
              "difference of relief [%], p, effect; times the rate");
  for (const EntryScore& score : course.entries) {
    std::string difference = "-";
    if (score.against_baseline.has_value()) {
      char p[48];
      std::snprintf(p, sizeof p, ", %.2g, %+.2f", score.against_baseline->p_holm,
                    score.against_baseline->test.effect);
      difference = with_interval(score.against_baseline->difference, 100, 1) + p;
      if (score.times_baseline.has_value())
        difference += "; " + with_interval(*score.times_baseline, 1, 2);
    }
    std::printf("  %-16s %-26s %-26s %-24s %-14s %9.3f %8.1f %6zu %5zu  %s\n", score.entry.c_str(),
                with_interval(score.relief_change, 100, 1).c_str(),
                with_interval(score.progress, 100, 1).c_str(),
                with_interval(score.rate_per_h, 100, 1).c_str(), half_text(score).c_str(),
                score.transport_per_joule.mean, 100 * score.stuck.mean, score.ended_early,
                score.failed, difference.c_str());
  }
}

std::string course_text(const WorldRanking& ranking) {
  std::string text;
  for (const std::string& level : ranking.course) text += (text.empty() ? "" : ", ") + level;
  return text.empty() ? "all courses" : text;
}

/// By how much more an entry levels in the other world, where it levels at all.
std::string rate_text(const RankedEntry& entry) {
  if (!(entry.reference.interval.high < 0.0 || entry.reference.interval.low > 0.0)) return "-";
  char text[32];
  std::snprintf(text, sizeof text, "%+.0f %%",
                100.0 * (entry.other.mean / entry.reference.mean - 1.0));
  return text;
}

void print_ranking(const WorldRanking& ranking) {
  std::printf("%s: %s orders the entries as %s with Kendall's tau %s, %zu beds\n",
              course_text(ranking).c_str(), ranking.other.c_str(), ranking.reference.c_str(),
              with_interval(ranking.tau, 1, 2).c_str(), ranking.tau.count);
  if (std::isfinite(ranking.reference_halves)) {
    std::printf("  (%s itself, a half of the beds beside the other: %.2f)\n",
                ranking.reference.c_str(), ranking.reference_halves);
  }
  if (ranking.course.empty()) return;
  std::printf("  %-16s %-26s %-26s %s\n", "entry, relief [%]", ranking.reference.c_str(),
              ranking.other.c_str(), "rate");
  for (const RankedEntry& entry : ranking.entries) {
    std::printf("  %-16s %-26s %-26s %s\n", entry.entry.c_str(),
                with_interval(entry.reference, 100, 1).c_str(),
                with_interval(entry.other, 100, 1).c_str(), rate_text(entry).c_str());
  }
}

Json json_of(const WorldRanking& ranking) {
  Json entries = Json::array();
  for (const RankedEntry& entry : ranking.entries) {
    entries.push_back({{"entry", entry.entry},
                       {ranking.reference, json_of(entry.reference)},
                       {ranking.other, json_of(entry.other)}});
  }
  return {{"ranking", ranking.other},     {"reference", ranking.reference},
          {"course", ranking.course},     {"beds", ranking.tau.count},
          {"tau", json_of(ranking.tau)},  {"reference_halves", ranking.reference_halves},
          {"entries", std::move(entries)}};
}

/// Entries by name, or files of entries, which are added.
std::vector<std::string> chosen_entries(const std::vector<std::string>& words,
                                        Benchmark& benchmark) {
  std::vector<std::string> names;
  for (const std::string& word : words) {
    std::error_code error;
    names.push_back(fs::is_regular_file(word, error) ? add_entry(word, benchmark) : word);
  }
  return names;
}

ChosenCampaign choose(const BenchArguments& arguments, const std::string& version) {
  Benchmark benchmark =
      read_benchmark(arguments.file.has_value() ? fs::path(*arguments.file) : benchmark_path());
  BenchmarkChoice choice;
  choice.suite = arguments.quick ? "quick" : arguments.suite;
  choice.training = arguments.training;
  choice.entries = chosen_entries(arguments.entries, benchmark);
  // Who is scored is scored beside the one it is compared with.
  if (!choice.entries.empty() && std::find(choice.entries.begin(), choice.entries.end(),
                                           arguments.against) == choice.entries.end())
    choice.entries.push_back(arguments.against);
  if (arguments.seeds.has_value()) choice.seeds = static_cast<std::size_t>(*arguments.seeds);
  if (arguments.sessions) choice.keep = CampaignKeep::kSession;
  ChosenCampaign chosen;
  chosen.plan = make_plan(benchmark_campaign(benchmark, choice), version);
  chosen.folder.path =
      fs::absolute(arguments.out.value_or((fs::path("out") / chosen.plan.settings.name).string()))
          .lexically_normal();
  return chosen;
}

int run_bench(const BenchArguments& arguments, const std::string& version) {
  catch_interrupts();
  const ChosenCampaign campaign = choose(arguments, version);
  const CampaignPlan& plan = campaign.plan;
  const CampaignLock lock(campaign.folder);
  CampaignJob job = whole_job(campaign, arguments.quiet);
  job.workers = worker_count(arguments.workers, plan, job.trial);
  const EngineOutcome outcome = execute(campaign, job, arguments.quiet);
  show_failures(outcome);
  if (interrupted()) {
    std::cerr << "screed: stopped; the same command goes on\n";
    return interrupted_exit_code();
  }
  if (!outcome.stopped.empty()) throw RunError(outcome.stopped);

  const ResultIndex results(campaign.folder.results());
  merge_and_note(plan, results, campaign.folder);
  const ValueTable runs = run_table(plan, results);
  const std::vector<CourseScore> courses =
      score_benchmark(plan, runs, curve_table(plan, results), arguments.against);
  const std::vector<WorldRanking> rankings = rank_worlds(plan, runs);
  if (arguments.json) {
    Json json = Json::array();
    for (const CourseScore& course : courses) {
      Json entries = Json::array();
      for (const EntryScore& score : course.entries) entries.push_back(json_of(score));
      json.push_back({{"course", course.levels},
                      {"duration_s", course.duration_s},
                      {"baseline", arguments.against},
                      {"entries", entries}});
    }
    for (const WorldRanking& ranking : rankings) json.push_back(json_of(ranking));
    std::cout << json.dump(2) << "\n";
  } else {
    for (const CourseScore& course : courses) print_course(course, arguments.against);
    for (const WorldRanking& ranking : rankings) print_ranking(ranking);
    std::printf("folder  %s\n", campaign.folder.path.c_str());
  }
  return count_results(plan, results).complete() ? 0 : 1;
}

}  // namespace

void register_level_bench_command(Command& level, Program& program) {
  auto arguments = std::make_shared<BenchArguments>();
  Command* command = level.add_subcommand(
      "bench", "Run the leveling benchmark; interrupted, the same command goes on");
  command
      ->add_option("ENTRY", arguments->entries,
                   "What to score: entries of the benchmark, algorithms of the robot, experiment "
                   "files with [experiment] algorithm and [parameters] (default: the suite's)")
      ->expected(0, -1);
  command->add_option("--suite", arguments->suite, "Which beds, sizes, soils and robots")
      ->type_name("NAME")
      ->show_default();
  command->add_flag("--quick", arguments->quick, "The suite quick: minutes, not hours");
  command->add_flag("--training", arguments->training,
                    "On the training beds; nothing is chosen on the test beds");
  command
      ->add_option("--against", arguments->against, "The entry that the others are compared with")
      ->type_name("ENTRY")
      ->show_default();
  add_number(*command, "--seeds", arguments->seeds,
             "How many beds of each kind (default: as the suite says)", {1, 1e6});
  command->add_option("--benchmark", arguments->file, "Another benchmark's file")
      ->type_name("FILE");
  command->add_option("--out", arguments->out, "Folder (default: out/leveling-SUITE)")
      ->type_name("FOLDER");
  add_number(*command, "--workers", arguments->workers,
             "Runs at a time (default: one on each processor, as many as memory allows)",
             {1, 4096});
  command->add_flag("--sessions", arguments->sessions, "Keep whole sessions of the runs");
  command->add_flag("--quiet", arguments->quiet, "Show no progress");
  command->add_flag("--json", arguments->json, "Print JSON");
  command->callback([arguments, &program] {
    program.action = [arguments, version = program.version] {
      return run_bench(*arguments, version);
    };
  });
}

}  // namespace screed
