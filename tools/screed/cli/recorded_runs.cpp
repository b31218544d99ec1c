// Runs that are there already.
#include "tools/screed/cli/recorded_runs.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <system_error>

#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"

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
                     ": left over from an unfinished run (interrupted, or still running); remove "
                     "it, then --missing runs it again");
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

}  // namespace

void leave_out_recorded(std::vector<Experiment>& experiments,
                        const std::optional<std::string>& root) {
  const size_t all = experiments.size();
  std::erase_if(experiments, [&](const Experiment& experiment) {
    return is_recorded(experiment, root.value_or(experiment.output_directory_prefix));
  });
  const size_t recorded = all - experiments.size();
  if (recorded > 0) std::cerr << "note: " << recorded << " of " << all << " have a run already\n";
}

}  // namespace screed
