// What a sweep consists of, as a file: so that workers, other processes, execute the same runs.
//
// A sweep has points, each run many times. Run i of point p is task i * points + p: runs are begun
// with the first of each point, and a sweep with more runs begins with the tasks of a smaller one.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/grid/grid_config.h"

namespace screed {

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

  size_t task_of(size_t point, size_t run) const { return run * points.size() + point; }
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

}  // namespace screed
