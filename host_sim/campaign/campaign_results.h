// The results of a campaign as files for other programs. Rows stand in the order of the runs, so
// that the bytes depend on nothing but what was run: not on workers, machines or interruptions.
#pragma once

#include <hdf5.h>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/core/json.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_folder.h"

namespace screed {

// A table of named columns whose values are numbers, texts or nothing, and its files. Equal tables
// give equal bytes.

/// A number, a text, a truth value or null.
using TableValue = Json;

class ValueTable {
 public:
  struct ValueColumn {
    std::string name;
    std::vector<TableValue> values;  ///< fewer than the table's rows: the rest is null
  };

  /// Begins a row.
  void add_row() { ++rows_; }
  /// Sets a value of the last row; an unknown column is added behind the others.
  void set(const std::string& column, TableValue value);
  /// Sets the values of a JSON object under its members' names: those of an inner object as
  /// `outer.inner`, those of a list as `outer.0`, a list of texts as one text with "; " between
  /// them. Columns that the row has already stay as they are.
  void set_all(const Json& object, const std::string& prefix = "");

  size_t rows() const { return rows_; }
  /// In the order in which they were first set.
  const std::vector<ValueColumn>& columns() const { return columns_; }
  const TableValue& at(size_t column, size_t row) const;
  /// A column by row: its numbers, truth values as 1 and 0; NaN for all else, and without it.
  std::vector<double> numbers(const std::string& column) const;
  /// Its texts; empty for all else, and without it.
  std::vector<std::string> texts(const std::string& column) const;

  /// Lines of cells (RFC 4180), the first with the names. Numbers are the shortest text that reads
  /// back to the same bits, truth values 1 and 0; null is an empty cell.
  std::string csv() const;
  /// A dataset for each column, in a new group: 64-bit integers where all values are, else 64-bit
  /// floating point with NaN for null, else text. Throws h5::Hdf5Failure.
  void write(hid_t file, const char* group) const;

 private:
  bool has(const std::string& column) const;

  std::vector<ValueColumn> columns_;
  std::map<std::string, size_t> numbers_;  ///< of the columns, by name
  size_t rows_ = 0;
};

/// How far a campaign has come.
struct CampaignCount {
  size_t runs = 0;
  size_t done = 0;
  size_t failed = 0;  ///< tried, and not done

  size_t missing() const { return runs - done - failed; }
  bool complete() const { return done == runs; }
  /// "complete: 30 runs", or "20 of 30 runs done, 1 failed, 9 missing".
  std::string text() const;
};
CampaignCount count_results(const CampaignPlan& plan, const ResultIndex& results);
/// Of these runs alone.
CampaignCount count_results(const CampaignPlan& plan, const ResultIndex& results,
                            const std::vector<size_t>& runs);

/// A row a run, as in runs.csv. Throws RunError when a result cannot be read.
ValueTable run_table(const CampaignPlan& plan, const ResultIndex& results);
/// A row a point of the leveling curves, as in curves.csv; none where they were not kept. Throws
/// likewise.
ValueTable curve_table(const CampaignPlan& plan, const ResultIndex& results);

/// Writes into the folder, each file complete or not at all:
///   runs.csv        a row a run: run, id, cell, seed, status, error, factors, figures of its
///                   summary
///   curves.csv      a row a point of a leveling curve, where they are kept
///   campaign.h5     the same as datasets, one a column, in the groups runs and curves
///   provenance.csv  a row a run: version, arithmetic, host, begin, duration, attempt; differs from
///                   time to time
/// Answers how many runs each arithmetic made (session_layout.h). Throws RunError when a file
/// cannot be written.
std::map<std::string, size_t> merge_results(const CampaignPlan& plan, const ResultIndex& results,
                                            const TaskFolder& folder);

}  // namespace screed
