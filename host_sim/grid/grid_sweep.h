// Many runs of the grid world on all cores: points of a sweep, each run so many times. The engine
// (task_engine.h) executes them in worker processes. What comes out does not depend on their
// number, and an interrupted sweep goes on where it stopped.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

#include "host_sim/engine/task_engine.h"
#include "host_sim/grid/grid_config.h"
#include "host_sim/grid/grid_run.h"

namespace screed {

// What a sweep consists of, as a file: so that workers, other processes, execute the same runs. Run
// i of point p is task i * points + p: runs are begun with the first of each point, and a sweep
// with more runs begins with the tasks of a smaller one.

struct SweepPoint {
  std::string label;  ///< for tables and charts
  double x = 0.0;     ///< place on the chart's axis
  GridConfig config;  ///< its seed is that of the first run; run i has seed + i
};

/// Most runs of a point.
inline constexpr size_t kMaxSweepRuns = 10'000'000;

struct SweepPlan {
  std::string version;  ///< of the program that the results are those of
  std::vector<GridConfig> points;
  std::vector<std::string> ids;  ///< identity of each point

  size_t point_of(size_t task) const { return task % points.size(); }
  size_t run_of(size_t task) const { return task / points.size(); }
  /// The identity of a run's result.
  std::string id_of(size_t point, size_t run) const {
    return ids[point] + "-" + std::to_string(run);
  }
  GridConfig config_of(size_t task) const;
};

/// Throws InputError for a configuration that is not allowed, or an image that cannot be read.
SweepPlan make_sweep_plan(const std::vector<SweepPoint>& points, const std::string& version);

/// The identity of a point: 32 hexadecimal digits. Equal for points whose runs give the same
/// results: of the same program version, with the same configuration and image. Throws InputError
/// when the image cannot be read.
std::string identity_of(const GridConfig& config, const std::string& version);

/// The plan as JSON text, and back. Throws InputError that names `file`.
std::string sweep_plan_text(const SweepPlan& plan);
SweepPlan read_sweep_plan(const std::filesystem::path& file);

/// The result of a run as JSON text, and back. Throws RunError for what is none.
std::string result_text(const GridResult& result);
GridResult parse_result(const std::string& text);

/// The worker of a sweep (task_worker.h): answers requests until `requests` ends. Throws InputError
/// when the folder has no plan.
void serve_sweep(const TaskFolder& folder, const std::string& program_version,
                 std::istream& requests, const std::function<void(const std::string&)>& answer);

struct SweepOptions {
  int runs = 30;    ///< a point
  int workers = 0;  ///< 0: one for each processor
  std::string version;
  /// Of the program, for a worker; the folder of the sweep is added. It is to call
  /// serve_sweep().
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
