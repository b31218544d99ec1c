// `screed level evolve FILE`: searches parameters of a leveling algorithm, and verifies the best.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/benchmark/evolution.h"
#include "host_sim/campaign/campaign_results.h"
#include "host_sim/core/atomic_file.h"
#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "tools/screed/campaign/campaign_work.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

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

std::string percent(const SeedMean& mean) {
  char text[64];
  if (std::isfinite(mean.interval.low)) {
    std::snprintf(text, sizeof text, "%.1f (%.1f to %.1f)", 100 * mean.mean,
                  100 * mean.interval.low, 100 * mean.interval.high);
  } else {
    std::snprintf(text, sizeof text, "%.1f", 100 * mean.mean);
  }
  return text;
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
  std::printf("generation %zu: mean %.1f, best %.1f: %s\n", generation + 1,
              100 * sum / static_cast<double>(file.population),
              100 * value_of(best->score, file.objective), text_of(file, *best).c_str());
  std::fflush(stdout);
}

void print_verification(const Evolution& evolution, const EvolutionFile& file) {
  std::printf("verified on %zu beds that the search never had; means and 95 %% intervals\n",
              file.verification_beds.size());
  std::printf("  %-12s %-26s %-26s %-26s %-34s %s\n", "entry", "relief [%]", "progress [%]",
              "relief as in the search [%]", "relief, less before [%], p", "parameters");
  for (std::size_t i = 0; i < evolution.fine.size(); ++i) {
    const Candidate& candidate = evolution.fine[i];
    std::string difference = "-";
    if (candidate.score.against_baseline.has_value()) {
      char p[32];
      std::snprintf(p, sizeof p, ", %.2g", candidate.score.against_baseline->p_holm);
      difference = percent(candidate.score.against_baseline->difference) + p;
    }
    std::printf("  %-12s %-26s %-26s %-26s %-34s %s\n", candidate.name.c_str(),
                percent(candidate.score.relief_change).c_str(),
                percent(candidate.score.progress).c_str(),
                percent(evolution.coarse[i].relief_change).c_str(), difference.c_str(),
                text_of(file, candidate).c_str());
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
      std::printf("nothing found is better than %s as it was\n", file.entry.c_str());
    }
    ContentHash hash;
    hash.add(archive_csv(file, evolution));
    std::printf("folder  %s\narchive %s\n", out.c_str(), hash.hex().c_str());
    return 0;
  } catch (const Stopped&) {
    std::cerr << "screed: stopped; the same command goes on\n";
    return interrupted_exit_code();
  }
}

}  // namespace

void register_level_evolve_command(Command& level, Program& program) {
  auto arguments = std::make_shared<EvolveArguments>();
  Command* command = level.add_subcommand(
      "evolve",
      "Search parameters of a leveling algorithm, verify the best; interrupted, the same command "
      "goes on");
  command->add_option("FILE", arguments->file, "INI file of what to search (docs/benchmark.md)")
      ->required();
  command->add_option("--benchmark", arguments->benchmark, "Another benchmark's file")
      ->type_name("FILE");
  command->add_option("--out", arguments->out, "Folder (default: out/NAME of the file)")
      ->type_name("FOLDER");
  add_number(*command, "--workers", arguments->workers,
             "Runs at a time (default: one on each processor, as many as memory allows)",
             {1, 4096});
  command->add_flag("--quiet", arguments->quiet, "Show no progress");
  command->callback([arguments, &program] {
    program.action = [arguments, version = program.version] {
      return run_evolve(*arguments, version);
    };
  });
}

}  // namespace screed
