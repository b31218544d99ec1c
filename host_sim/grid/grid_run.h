// One run of the grid world, cycle by cycle, and what came out of it.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "host_sim/grid/grid_config.h"
#include "host_sim/grid/grid_swarm.h"
#include "host_sim/grid/grid_world.h"

namespace screed {

struct GridResult {
  bool level = false;  ///< the stop rule was met within the cap
  uint64_t cycles = 0;
  uint64_t units = 0;      ///< successful pick-ups
  uint64_t min_units = 0;  ///< no agents could have done with fewer (GridWorld::work_left)
  uint64_t straight = 0;   ///< steps of all agents
  uint64_t diagonal = 0;

  /// Of all agents together, in cells.
  [[nodiscard]] double distance() const;
  bool operator==(const GridResult&) const = default;
};

/// A point of the progress curve. progress = 1 - work_left / work_left at the start: 0 untouched, 1
/// level. It is an L1 distance to the nearest level terrain.
struct GridProgress {
  uint64_t cycle;
  uint64_t units;
  double distance;
  double progress;
};

class GridRun {
 public:
  /// Throws InputError for a configuration out of range, an unreadable image, more agents than
  /// cells.
  explicit GridRun(const GridConfig& config);

  /// Level, or at the cap.
  [[nodiscard]] bool finished() const { return level_ || cycles() >= config_.max_cycles; }
  void cycle();

  [[nodiscard]] const GridConfig& config() const { return config_; }
  [[nodiscard]] const GridWorld& world() const { return *world_; }
  [[nodiscard]] const GridSwarm& swarm() const { return *swarm_; }
  [[nodiscard]] uint64_t cycles() const { return swarm_->counts().cycles; }
  [[nodiscard]] GridResult result() const;
  [[nodiscard]] GridProgress progress() const;

 private:
  GridConfig config_;
  std::unique_ptr<GridWorld> world_;
  std::unique_ptr<GridSwarm> swarm_;
  uint64_t min_units_ = 0;
  bool level_ = false;
};

/// A whole run.
GridResult run_grid(const GridConfig& config);

}  // namespace screed
