// The results of a campaign as files for other programs. Rows stand in the order of the runs, so
// that the bytes depend on nothing but what was run: not on workers, machines or interruptions.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "host_sim/campaign/campaign_plan.h"
#include "host_sim/campaign/value_table.h"
#include "host_sim/engine/result_store.h"
#include "host_sim/engine/task_folder.h"

namespace screed {

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
