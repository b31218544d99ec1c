// Experiments one after the other.
#include "tools/screed/cli/run_batch.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/experiment/experiment_table.h"
#include "host_sim/run/session/run_folder.h"
#include "host_sim/run/world/world_setup.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/progress_bar.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

bool ended_early(const fs::path& run) {
  std::ifstream file(run / "summary.json");
  const auto summary = Json::parse_or_null(file);
  return summary.is_object() && summary.value("stopped_early", false);
}

/// Whether the run's experiment.ini gives the same values. Compared as read: a newer program may
/// write keys that the run's did not know.
bool is_run_of(const Experiment& experiment, const fs::path& run) {
  try {
    return read_experiment(run / "experiment.ini").text() == experiment.text();
  } catch (const InputError&) {
    return false;
  }
}

/// Whether the experiment has a run, with a note about one that is not what it looks like.
bool is_recorded(const Experiment& experiment, const fs::path& root) {
  const fs::path run = root / (experiment.experiment.name + "-0001");
  std::error_code error;
  if (const fs::path partial = run.string() + ".partial"; fs::exists(partial, error)) {
    throw InputError(partial.string() +
                     (is_running(partial)
                          ? ": this run is being recorded now; wait for its end"
                          : ": left over from an unfinished run; remove it, then --missing "
                            "runs it again"));
  }
  if (!fs::exists(run, error)) return false;
  if (!fs::exists(run / "session.h5", error))
    throw InputError(run.string() + ": is no run, it has no session.h5; remove it");
  const char* const remedy = "; remove it, then --missing runs it again\n";
  if (!is_run_of(experiment, run)) {
    std::cerr << "note: " << run.string() << " is a run of other values" << remedy;
  } else if (ended_early(run)) {
    std::cerr << "note: " << run.string() << " ended early" << remedy;
  }
  return true;
}

/// Removes the experiments that have a run NAME-0001 in `root` (without it, in their own
/// output_directory_prefix) and says on stderr how many. Notes there as well which of these runs
/// ended early or are runs of other values: they stay as they are. Throws InputError when a folder
/// of that name is no run, or is left over from one that did not end.
void leave_out_recorded(std::vector<Experiment>& experiments,
                        const std::optional<std::string>& root) {
  const size_t all = experiments.size();
  std::erase_if(experiments, [&](const Experiment& experiment) {
    return is_recorded(experiment, root.value_or(experiment.output_directory_prefix));
  });
  const size_t recorded = all - experiments.size();
  if (recorded > 0) std::cerr << "note: " << recorded << " of " << all << " have a run already\n";
}

std::vector<Experiment> read_all(const BatchArguments& arguments,
                                 const std::vector<std::string>& overrides) {
  std::vector<Experiment> experiments;
  if (arguments.table.has_value()) {
    if (arguments.files.size() != 1)
      throw InputError("--table needs one FILE, which says what its rows have in common");
    for (const ExperimentRow& row :
         select_rows(read_experiment_table(*arguments.table), arguments.rows))
      experiments.push_back(read_experiment_row(arguments.files.front(), row, overrides));
  } else {
    for (const std::string& file : arguments.files)
      experiments.push_back(read_experiment(file, overrides));
  }
  std::set<std::string> told;  // the rows of a table have the notes of their file in common
  for (const Experiment& experiment : experiments) {
    for (const std::string& note : experiment.notes)
      if (told.insert(note).second) std::cerr << "note: " << note << "\n";
  }
  if (arguments.missing) leave_out_recorded(experiments, arguments.out);
  return experiments;
}

/// Checks several experiments; what is wrong with one begins with its name. Building a world on
/// soil takes a quarter of a second, so many of them show how far they are.
void check_all(const std::vector<Experiment>& experiments, SimulationOptions options, bool quiet) {
  ProgressBar bar(std::cerr);
  for (size_t i = 0; i < experiments.size(); ++i) {
    const std::string& name = experiments[i].experiment.name;
    options.setup_progress = [&](std::string_view task, double of_task) {
      stop_if_interrupted("checking " + name + "; no experiment was begun");
      const double share = static_cast<double>(i) / static_cast<double>(experiments.size());
      if (!quiet)
        bar.show_share(share, filled("checking {}: {} {*100:.0f} %", name, task, of_task));
    };
    try {
      check_simulation(experiments[i], options);
    } catch (const InputError& error) {
      bar.clear();
      throw InputError("experiment " + name + ": " + error.what());
    }
  }
  bar.clear();
}

SimulationSummary run_one(const Experiment& experiment, SimulationOptions options, bool quiet,
                          const std::string& label) {
  const bool can_run = !options.image.has_value() || std::filesystem::exists(*options.image);
  if (const auto note = large_bed_note(experiment, options.least_cell_m); can_run && note)
    std::cerr << "note: " << label << *note << "\n";
  TaskBar setup_bar(quiet, label);
  options.setup_progress = setup_bar.progress();
  std::optional<ProgressBar> bar;
  if (!quiet) {
    bar.emplace(std::cerr);
    options.progress = [&](const SimulationProgress& progress) {
      setup_bar.clear();
      const double before_m = progress.level_deviation_before_m;
      const double now_m = progress.level_deviation_m;
      std::string note = label + filled("off level {*1000:.1f} mm", now_m);
      if (now_m != before_m) note += ", " + change_text(before_m, now_m);
      bar->show(progress.time_s, progress.duration_s, note);
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

void add_batch_options(Command& command, BatchArguments& arguments) {
  command.add_option("FILE", arguments.files,
                     "Experiment files (INI), run one after the other, each in its own world");
  Option* table =
      command
          .add_option("--table", arguments.table,
                      "CSV table with one experiment per row; FILE holds the common keys")
          ->type_name("FILE");
  command
      .add_option("--rows", arguments.rows,
                  "Run only the rows that match this name pattern, e.g. 'e_*'")
      ->type_name("PATTERN")
      ->one_value_each()
      ->needs(table);
  command.add_flag("--missing", arguments.missing,
                   "Skip experiments whose run folder (NAME-0001) already exists");
  command.add_option("--set", arguments.sets, "Override a key: section.key=value")
      ->type_name("KEY=VALUE")
      ->one_value_each();
  command
      .add_option("--out", arguments.out,
                  "Run folder, must not exist yet; with several files, --table or --missing the "
                  "parent folder of the run folders")
      ->type_name("FOLDER");
  command.add_flag("--no-pictures", arguments.no_pictures,
                   "Draw no pictures; `screed session export --pictures` draws them later");
  command.add_flag("--quiet", arguments.quiet,
                   "Show no progress; print only run folder and content hash");
  command.add_flag("--json", arguments.json, "Print the summary as JSON");
}

void run_batch(const BatchArguments& arguments, const std::vector<std::string>& overrides,
               SimulationOptions options, const Report& report, const Prepare& prepare) {
  std::vector<std::string> all = arguments.sets;
  all.insert(all.end(), overrides.begin(), overrides.end());
  const std::vector<Experiment> experiments = read_all(arguments, all);
  const bool several = arguments.several();
  options.pictures = !arguments.no_pictures;
  options.stop = &interrupted();
  catch_interrupts();
  if (several) {
    check_all(experiments, options, arguments.quiet);
    if (arguments.out.has_value()) options.root = *arguments.out;
  } else if (arguments.out.has_value()) {
    options.out = *arguments.out;
  }
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
    try {
      report(experiments[i], run_one(experiments[i], of_run, arguments.quiet, label));
    } catch (const TaskStopped& stopped) {
      std::cerr << "note: " << experiments[i].experiment.name << " was stopped while "
                << stopped.what() << "; there is no run of it\n";
    }
  }
}

std::string json_of(const std::vector<SimulationSummary>& summaries, bool several) {
  std::string text;
  for (const SimulationSummary& summary : summaries)
    text += (text.empty() ? "" : ",\n") + summary_json_with_folder(summary).dump(2);
  if (several) return "[\n" + text + "\n]\n";
  return text.empty() ? "" : text + "\n";
}

}  // namespace screed
