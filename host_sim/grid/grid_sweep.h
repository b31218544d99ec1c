// Many runs of the grid world on all cores: points of a sweep, each run so many times. The engine
// (task_engine.h) executes them in worker processes. What comes out does not depend on their
// number, and an interrupted sweep goes on where it stopped.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/engine/task_engine.h"
#include "host_sim/grid/grid_config.h"
#include "host_sim/grid/grid_run.h"
#include "host_sim/grid/grid_sweep_plan.h"

namespace screed {

struct SweepOptions {
  int runs = 30;    ///< a point
  int workers = 0;  ///< 0: one for each processor
  std::string version;
  /// Of the program, for a worker; the folder of the sweep is added. It is to call
  /// serve_sweep() (grid_sweep_worker.h).
  std::vector<std::string> worker_arguments;
  /// Where runs are stored as soon as they have ended; runs that are there are not run again.
  /// Empty: nothing is kept.
  std::filesystem::path folder;
  /// Once all runs are there they are written to this file: CSV, a line a run, by point and run.
  /// It has all runs that are stored, be they more than asked for. Empty: no file; only with a
  /// folder.
  std::filesystem::path table;
  const std::atomic<bool>* stop = nullptr;  ///< set to end early
  std::function<void(const EngineProgress&)> progress;
  /// Is told what is odd about stored results, a line each.
  std::function<void(const std::string&)> note;
};

struct SweepResult {
  bool complete = false;                         ///< false when stopped early
  size_t resumed = 0;                            ///< runs that were there already
  std::vector<std::vector<GridResult>> results;  ///< by point, then run; when complete
};

/// Throws InputError for a wrong configuration, a table of another sweep, a folder in use;
/// RunError when something cannot be written or runs fail.
SweepResult run_sweep(const std::vector<SweepPoint>& points, const SweepOptions& options);

/// Mean, standard error of the mean (0 for a single value) and extremes.
struct Summary {
  double mean = 0.0;
  double standard_error = 0.0;
  double minimum = 0.0;
  double maximum = 0.0;

  /// Half the width of the 95 % confidence interval (normal approximation).
  [[nodiscard]] double confidence() const { return 1.96 * standard_error; }
};
Summary summarise(const std::vector<double>& values);

}  // namespace screed
