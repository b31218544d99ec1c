// A table of experiments: many that have one experiment file in common, a row of a CSV file for
// each.
//
// The heading names columns by keys of experiment files as section.key ("vehicle.x"); one column
// may hold several keys ("experiment.seed + parameters.random_seed"). The column experiment.name is
// required, and names are unique. An empty cell is not given: the experiment file decides.
// docs/experiments.md has an example.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/core/ini_file.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// What one row of a table says.
struct ExperimentRow {
  struct Value {
    IniEntry entry;
    std::string column;  ///< the heading above it
  };
  std::string name;   ///< value of experiment.name
  std::string where;  ///< file, line and name, as messages call the row
  std::vector<Value> values;
};

/// The rows in their order. Throws InputError, naming file, line and column, for a missing file or
/// heading, an unknown column, a key in two columns, a row of more or fewer cells than the heading,
/// a missing name and a name that is given twice. Values are checked when a row is read as an
/// experiment.
std::vector<ExperimentRow> read_experiment_table(const std::filesystem::path& path);

/// The rows whose name matches one of `patterns` (as file names in a shell: * ? [...]), in the
/// table's order; all rows without a pattern. Throws InputError for a pattern that matches none.
std::vector<ExperimentRow> select_rows(std::vector<ExperimentRow> rows,
                                       const std::vector<std::string>& patterns);

/// Reads the experiment file `path`, applies the values of `row` on top, then `overrides`
/// ("section.key=value"). Values are in SI units, whatever the file's are. Throws InputError; what
/// is wrong with the row names its table, line, name and column.
Experiment read_experiment_row(const std::filesystem::path& path, const ExperimentRow& row,
                               const std::vector<std::string>& overrides = {});

}  // namespace screed
