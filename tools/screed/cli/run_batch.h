// Several experiments as a batch, for `screed sim` and `screed record`: what the user may say
// about them, and running one after the other.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>
#include "tools/command_line/command.h"

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation.h"

namespace screed {

struct BatchArguments {
  std::vector<std::string> files;
  std::optional<std::string> table;  ///< CSV file with a row for each experiment
  std::vector<std::string> rows;     ///< patterns of the names of its rows that run; empty: all
  bool missing = false;              ///< leave out what has a run already
  std::vector<std::string> sets;
  std::optional<std::string> out;
  bool no_pictures = false;
  bool quiet = false;
  bool json = false;

  /// Whether they may be more than one experiment; each then makes a folder of its own.
  bool several() const { return files.size() > 1 || table.has_value() || missing; }
};

/// FILE..., --table, --rows, --missing, --set, --out, --no-pictures, --quiet and --json.
void add_batch_options(Command& command, BatchArguments& arguments);

/// Called after each run.
using Report = std::function<void(const Experiment&, const SimulationSummary&)>;

/// Called before each run, with the options of that run.
using Prepare = std::function<void(const Experiment&, SimulationOptions&)>;

/// Reads and checks all files or rows, then runs them one after the other, each in a world of its
/// own; tells on stderr what the user should know. `overrides` hold for all. Of one file --out is
/// the run folder, of several() the folder in which each makes one of its own. Ctrl-C ends the run
/// that goes on, saved as it is, and the batch; a run that is still being set up leaves nothing.
/// Throws InputError before the first run when anything is wrong with one of the files or rows,
/// TaskStopped when a signal comes while they are checked.
void run_batch(const BatchArguments& arguments, const std::vector<std::string>& overrides,
               SimulationOptions options, const Report& report, const Prepare& prepare = {});

/// The summaries as the commands print them under --json: of one file its object, of several an
/// array.
std::string json_of(const std::vector<SimulationSummary>& summaries, bool several);

}  // namespace screed
