// Experiments one after the other.
#include "tools/screed/cli/run_batch.h"

#include <cstdio>
#include <iostream>

#include "host_sim/core/errors.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

std::vector<Experiment> read_all(const BatchArguments& arguments,
                                 const std::vector<std::string>& overrides) {
  std::vector<Experiment> experiments;
  for (const std::string& file : arguments.files) {
    experiments.push_back(read_experiment(file, overrides));
    for (const std::string& note : experiments.back().notes) std::cerr << "note: " << note << "\n";
  }
  return experiments;
}

SimulationSummary run_one(const Experiment& experiment, SimulationOptions options, bool quiet,
                          const std::string& label) {
  std::optional<ProgressBar> bar;
  if (!quiet) {
    bar.emplace(std::cerr);
    options.progress = [&bar, &label](const SimulationProgress& progress) {
      char flat[32];
      std::snprintf(flat, sizeof flat, "flat %.1f %%", progress.flatness * 100.0);
      bar->show(progress.time_s, progress.duration_s, label + flat);
    };
  }
  SimulationSummary summary = run_simulation(experiment, options);
  if (bar.has_value()) bar->finish();
  for (const auto& leftover : summary.leftovers) {
    std::cerr << "note: " << leftover.string()
              << " is left of a run that did not end; remove it when it is not needed\n";
  }
  return summary;
}

}  // namespace

void add_batch_options(CLI::App& command, BatchArguments& arguments) {
  command.add_option("FILE", arguments.files,
                     "Experiment files (INI), run one after the other, each in its own world");
  command.add_option("--set", arguments.sets, "Override a key: section.key=value; may be repeated")
      ->type_size(1)
      ->allow_extra_args(false);
  command.add_option(
      "--out", arguments.out,
      "Run folder, must not exist yet; with several files the parent folder of their run folders");
  command.add_flag("--quiet", arguments.quiet,
                   "Show no progress; print only run folder and content hash");
  command.add_flag("--json", arguments.json, "Print the summary as JSON");
}

void run_batch(const BatchArguments& arguments, const std::vector<std::string>& overrides,
               SimulationOptions options, const Report& report, const Prepare& prepare) {
  std::vector<std::string> all = arguments.sets;
  all.insert(all.end(), overrides.begin(), overrides.end());
  const std::vector<Experiment> experiments = read_all(arguments, all);
  const bool several = experiments.size() > 1;
  if (several) {
    for (const Experiment& experiment : experiments) {
      check_simulation(experiment, options);
    }
    if (arguments.out.has_value()) options.root = *arguments.out;
  } else if (arguments.out.has_value()) {
    options.out = *arguments.out;
  }
  options.stop = &interrupted();
  catch_interrupts();
  for (std::size_t i = 0; i < experiments.size(); ++i) {
    if (interrupted()) {
      std::cerr << "note: " << experiments.size() - i << " of " << experiments.size()
                << " experiments were not begun\n";
      return;
    }
    const std::string label = several ? std::to_string(i + 1) + "/" +
                                            std::to_string(experiments.size()) + " " +
                                            experiments[i].experiment.name + "  "
                                      : "";
    SimulationOptions of_run = options;
    if (prepare) prepare(experiments[i], of_run);
    report(experiments[i], run_one(experiments[i], of_run, arguments.quiet, label));
  }
}

std::string json_of(const std::vector<SimulationSummary>& summaries, bool several) {
  if (!several) return summaries.empty() ? "" : summary_json(summaries.front());
  std::string text = "[\n";
  for (const SimulationSummary& summary : summaries) {
    if (text.size() > 2) text += ",\n";
    std::string one = summary_json(summary);
    while (!one.empty() && one.back() == '\n') one.pop_back();
    text += one;
  }
  return text + "\n]\n";
}

}  // namespace screed
