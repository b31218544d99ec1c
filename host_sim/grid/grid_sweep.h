// Many runs of the grid world on all cores: points of a sweep, each run so many times. What comes
// out does not depend on the number of threads, and an interrupted sweep goes on where it stopped.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/grid/grid_config.h"
#include "host_sim/grid/grid_run.h"

namespace screed {

struct SweepPoint {
  std::string label;  ///< for tables and charts
  double x = 0.0;     ///< place on the chart's axis
  GridConfig config;  ///< its seed is that of the first run; run i has seed + i
};

struct SweepOptions {
  int runs = 30;    ///< a point
  int threads = 0;  ///< 0: as many as the machine has cores
  /// Empty: nothing is kept. Otherwise every finished run is appended to this file at once, in one
  /// write; runs that it has already are not run again. Once all are there it is rewritten in
  /// order.
  std::filesystem::path results;
  const std::atomic<bool>* stop = nullptr;  ///< set to end early
  /// Called from any thread, one at a time, after each run.
  std::function<void(size_t done, size_t all)> progress;
};

struct SweepResult {
  bool complete = false;                         ///< false when stopped early
  size_t resumed = 0;                            ///< runs found in the results file
  std::vector<std::vector<GridResult>> results;  ///< by point, then run
};

/// Throws InputError for a wrong configuration, a results file of another sweep or in use; RunError
/// when it cannot be written.
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
