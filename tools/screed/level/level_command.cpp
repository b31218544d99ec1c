// `screed level ...`: how well algorithms level, and the search for better ones. Bench runs the
// leveling benchmark and prints its table; evolve searches parameters of an algorithm and verifies
// the best.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "host_sim/benchmark/benchmark_file.h"
#include "host_sim/benchmark/benchmark_score.h"
#include "host_sim/benchmark/evolution.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/name_list.h"
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
               {"level_change", json_of(score.level_change)},
               {"progress", json_of(score.progress)},
               {"progress_w2", json_of(score.progress_w2)},
               {"relief_change", json_of(score.relief_change)},
               {"roughness_change", json_of(score.roughness_change)},
               {"height_change_m", json_of(score.height_change_m)},
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

/// "15/30, 1.48 h": how many beds came to half of their height about level, and when half of them
/// had.
std::string half_text(const EntryScore& score) {
  std::string text = std::to_string(score.halved) + "/" + std::to_string(score.runs + score.failed);
  if (!std::isfinite(score.half_time_s)) return text;
  return text + filled(", {:.2f} h", score.half_time_s / 3600.0);
}

/// "-12.3 (-15.1 to -9.8)"; of a single bed without an interval.
std::string with_interval(const SeedMean& mean, double factor, int digits) {
  const std::string form = "{:." + std::to_string(digits) + "f}";
  if (!std::isfinite(mean.interval.low)) return filled(form, factor * mean.mean);
  return filled(form + " (" + form + " to " + form + ")", factor * mean.mean,
                factor * mean.interval.low, factor * mean.interval.high);
}
std::string percent(const SeedMean& mean) {
  return with_interval(mean, 100, 1);
}

void print_course(const CourseScore& course, const std::string& against) {
  print("{}, {:.0f} s; means over the beds and 95 % intervals; against {}: Wilcoxon, Holm\n",
        name_list(course.levels), course.duration_s, against);
  print(
      "  {:-16s} {:-26s} {:-26s} {:-26s} {:-26s} {:8s} {:8s} {:-14s} {:8s} {:8s} {:6s} {:5s}  {}\n",
      "entry", "height about level [%]", "progress W1 [%]", "progress W2 [%]", "relief [%]",
      "rough %", "mean mm", "half by", "cm3 m/J", "stuck %", "early", "lost",
      "difference of height about level [%], p, effect; times the progress W1");
  for (const EntryScore& score : course.entries) {
    std::string difference = "-";
    if (const auto& against_it = score.against_baseline; against_it.has_value()) {
      difference = percent(against_it->difference) +
                   filled(", {:.2g}, {:+.2f}", against_it->p_holm, against_it->test.effect);
      if (score.times_baseline.has_value())
        difference += "; " + with_interval(*score.times_baseline, 1, 2);
    }
    print(
        "  {:-16s} {:-26s} {:-26s} {:-26s} {:-26s} {*100:8.1f} {*1000:8.1f} {:-14s} {:8.3f} "
        "{*100:8.1f} "
        "{:6s} {:5s}  {}\n",
        score.entry, percent(score.level_change), percent(score.progress),
        percent(score.progress_w2), percent(score.relief_change), score.roughness_change.mean,
        score.height_change_m.mean, half_text(score), score.transport_per_joule.mean,
        score.stuck.mean, score.ended_early, score.failed, difference);
  }
}

/// By how much more an entry levels in the other world, where it levels at all.
std::string rate_text(const RankedEntry& entry) {
  if (!(entry.reference.interval.high < 0.0 || entry.reference.interval.low > 0.0)) return "-";
  return filled("{:+.0f} %", 100.0 * (entry.other.mean / entry.reference.mean - 1.0));
}

void print_ranking(const WorldRanking& ranking) {
  const std::string course = ranking.course.empty() ? "all courses" : name_list(ranking.course);
  if (std::isfinite(ranking.tau.mean))
    print("{}: {} orders the entries as {} with Kendall's tau {}, {} beds\n", course, ranking.other,
          ranking.reference, with_interval(ranking.tau, 1, 2), ranking.tau.count);
  else  // one entry, or all alike
    print("{}: {} beside {}, {} beds\n", course, ranking.other, ranking.reference,
          ranking.tau.count);
  if (std::isfinite(ranking.reference_halves))
    print("  ({} itself, a half of the beds beside the other: {:.2f})\n", ranking.reference,
          ranking.reference_halves);
  if (ranking.course.empty()) return;
  print("  {:-16s} {:-26s} {:-26s} {}\n", "entry, height [%]", ranking.reference, ranking.other,
        "rate");
  for (const RankedEntry& entry : ranking.entries)
    print("  {:-16s} {:-26s} {:-26s} {}\n", entry.entry, percent(entry.reference),
          percent(entry.other), rate_text(entry));
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
  if (!arguments.quiet) note_work(campaign, job);
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
    print_json(json);
  } else {
    for (const CourseScore& course : courses) print_course(course, arguments.against);
    for (const WorldRanking& ranking : rankings) print_ranking(ranking);
    print("folder  {}\n", campaign.folder.path);
  }
  return count_results(plan, results).complete() ? 0 : 1;
}

// ---- evolve ----

struct EvolveArguments {
  std::string file;
  std::optional<std::string> benchmark;
  std::optional<std::string> out;
  std::optional<int> workers;
  bool quiet = false;
};

/// The user wants it to end.
struct Stopped {};

/// One campaign, to its end.
std::vector<EntryScore> run_task(const EvolveArguments& arguments, const std::string& version,
                                 const fs::path& out, const EvolutionFile& file,
                                 const Benchmark& benchmark, const EvolutionTask& task) {
  ChosenCampaign campaign;
  campaign.plan = make_plan(evolution_campaign(file, benchmark, task), version);
  campaign.folder.path = out / task.name;
  const CampaignLock lock(campaign.folder);
  CampaignJob job = whole_job(campaign, true);
  job.workers = worker_count(arguments.workers, campaign.plan, job.trial);
  const EngineOutcome outcome = execute(campaign, job, arguments.quiet);
  show_failures(outcome);
  if (interrupted()) throw Stopped{};
  if (!outcome.stopped.empty()) throw RunError(outcome.stopped);
  const ResultIndex results(campaign.folder.results());
  merge_and_note(campaign.plan, results, campaign.folder);
  return score_benchmark(campaign.plan, run_table(campaign.plan, results), {}, task.against)
      .at(0)
      .entries;
}

std::string text_of(const EvolutionFile& file, const Candidate& candidate) {
  std::string text;
  for (std::size_t i = 0; i < candidate.values.size(); ++i) {
    text += (text.empty() ? "" : ", ") + file.parameters[i].name + " " +
            std::to_string(candidate.values[i]);
  }
  return text.empty() ? "as before" : text;
}

void print_generation(const EvolutionFile& file, std::size_t generation,
                      const Evolution& evolution) {
  const auto begin = evolution.archive.end() - static_cast<std::ptrdiff_t>(file.population);
  const auto best =
      std::min_element(begin, evolution.archive.end(), [&](const auto& a, const auto& b) {
        return value_of(a.score, file.objective) < value_of(b.score, file.objective);
      });
  double sum = 0.0;
  for (auto it = begin; it != evolution.archive.end(); ++it)
    sum += value_of(it->score, file.objective);
  print("generation {}: mean {:.1f}, best {:.1f}: {}\n", generation + 1,
        100 * sum / static_cast<double>(file.population),
        100 * value_of(best->score, file.objective), text_of(file, *best));
  std::cout << std::flush;
}

void print_verification(const Evolution& evolution, const EvolutionFile& file) {
  print("verified on {} beds that the search never had; means and 95 % intervals\n",
        file.verification_beds.size());
  constexpr const char* kRow = "  {:-12s} {:-26s} {:-26s} {:-26s} {:-34s} {}\n";
  print(kRow, "entry", "height about level [%]", "progress W1 [%]", "as in the search [%]",
        "less before [%], p", "parameters");
  for (std::size_t i = 0; i < evolution.fine.size(); ++i) {
    const Candidate& candidate = evolution.fine[i];
    std::string difference = "-";
    if (const auto& before = candidate.score.against_baseline; before.has_value())
      difference = percent(before->difference) + filled(", {:.2g}", before->p_holm);
    print(kRow, candidate.name, percent(candidate.score.level_change),
          percent(candidate.score.progress), percent(evolution.coarse[i].level_change), difference,
          text_of(file, candidate));
  }
}

int run_evolve(const EvolveArguments& arguments, const std::string& version) {
  catch_interrupts();
  const EvolutionFile file = read_evolution_file(arguments.file);
  const Benchmark benchmark = read_benchmark(
      arguments.benchmark.has_value() ? fs::path(*arguments.benchmark) : benchmark_path());
  const fs::path out =
      fs::absolute(arguments.out.value_or((fs::path("out") / file.path.stem()).string()))
          .lexically_normal();
  const auto save = [&](const Evolution& evolution) {
    write_file(out / "archive.csv", archive_csv(file, evolution));
  };
  try {
    const Evolution evolution = evolve(
        file, benchmark,
        [&](const Benchmark& with_candidates, const EvolutionTask& task) {
          return run_task(arguments, version, out, file, with_candidates, task);
        },
        [&](std::size_t generation, const Evolution& so_far) {
          save(so_far);
          if (!arguments.quiet) print_generation(file, generation, so_far);
        });
    print_verification(evolution, file);
    if (evolution.best.has_value()) {
      write_file(out / "best.ini", entry_text(file, benchmark, evolution.fine[*evolution.best]));
    } else {
      fs::remove(out / "best.ini");  // of another search in this folder
      print("nothing found is better than {} as it was\n", file.entry);
    }
    ContentHash hash;
    hash.add(archive_csv(file, evolution));
    print("folder  {}\narchive {}\n", out, hash.hex());
    return 0;
  } catch (const Stopped&) {
    std::cerr << "screed: stopped; the same command goes on\n";
    return interrupted_exit_code();
  }
}

void register_bench(Command& level, Program& program) {
  auto [command, arguments] = add_subcommand<BenchArguments>(
      level, program, "bench", "Run the leveling benchmark; interrupted, the same command goes on",
      run_bench);
  command
      .add_option("ENTRY", arguments.entries,
                  "What to score: entries of the benchmark, algorithms of the robot, experiment "
                  "files with [experiment] algorithm and [parameters] (default: the suite's)")
      ->expected(0, -1);
  command.add_option("--suite", arguments.suite, "Which beds, sizes, soils and robots")
      ->type_name("NAME")
      ->show_default();
  command.add_flag("--quick", arguments.quick, "The suite quick: minutes, not hours");
  command.add_flag("--training", arguments.training,
                   "On the training beds; nothing is chosen on the test beds");
  command.add_option("--against", arguments.against, "The entry that the others are compared with")
      ->type_name("ENTRY")
      ->show_default();
  add_number(command, "--seeds", arguments.seeds,
             "How many beds of each kind (default: as the suite says)", {1, 1e6});
  command.add_option("--benchmark", arguments.file, "Another benchmark's file")->type_name("FILE");
  command.add_option("--out", arguments.out, "Folder (default: out/leveling-SUITE)")
      ->type_name("FOLDER");
  add_number(command, "--workers", arguments.workers,
             "Runs at a time (default: one on each processor, as many as memory allows)",
             {1, 4096});
  command.add_flag("--sessions", arguments.sessions, "Keep whole sessions of the runs");
  command.add_flag("--quiet", arguments.quiet, "Show no progress");
  command.add_flag("--json", arguments.json, "Print JSON");
}

void register_evolve(Command& level, Program& program) {
  auto [command, arguments] = add_subcommand<EvolveArguments>(
      level, program, "evolve",
      "Search parameters of a leveling algorithm, verify the best; interrupted, the same command "
      "goes on",
      run_evolve);
  command.add_option("FILE", arguments.file, "INI file of what to search (docs/benchmark.md)")
      ->required();
  command.add_option("--benchmark", arguments.benchmark, "Another benchmark's file")
      ->type_name("FILE");
  command.add_option("--out", arguments.out, "Folder (default: out/NAME of the file)")
      ->type_name("FOLDER");
  add_number(command, "--workers", arguments.workers,
             "Runs at a time (default: one on each processor, as many as memory allows)",
             {1, 4096});
  command.add_flag("--quiet", arguments.quiet, "Show no progress");
}

}  // namespace

void register_level_command(Command& root, Program& program) {
  Command* level = root.add_subcommand("level", "Measure how well algorithms level");
  register_bench(*level, program);
  register_evolve(*level, program);
}

}  // namespace screed
