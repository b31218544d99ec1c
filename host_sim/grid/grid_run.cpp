// A run of the grid world.
#include "host_sim/grid/grid_run.h"

#include <string>

#include "host_sim/core/errors.h"

namespace screed {

double GridResult::distance() const {
  SwarmCounts counts;
  counts.straight = straight;
  counts.diagonal = diagonal;
  return counts.distance();
}

GridRun::GridRun(const GridConfig& config) : config_(with_defaults(config)) {
  check(config_);
  const GridTerrain terrain = make_terrain(config_);
  if (static_cast<size_t>(config_.agents) > terrain.heights.size()) {
    throw InputError("grid: agents = " + std::to_string(config_.agents) +
                     "; allowed is at most one a cell, " + std::to_string(terrain.heights.size()));
  }
  world_ = std::make_unique<GridWorld>(terrain, config_.noise.border, config_.stop);
  swarm_ = make_swarm(config_, *world_);
  min_units_ = world_->work_left(0, swarm_->size());
  level_ = world_->is_level();
}

void GridRun::cycle() {
  swarm_->cycle(*world_);
  level_ = world_->is_level();
}

GridResult GridRun::result() const {
  const SwarmCounts& counts = swarm_->counts();
  return {level_, counts.cycles, counts.units, min_units_, counts.straight, counts.diagonal};
}

GridProgress GridRun::progress() const {
  const SwarmCounts& counts = swarm_->counts();
  const uint64_t left = world_->work_left(counts.carried, swarm_->size());
  const double share =
      min_units_ == 0 ? 1.0 : 1.0 - static_cast<double>(left) / static_cast<double>(min_units_);
  return {counts.cycles, counts.units, counts.distance(), share};
}

GridResult run_grid(const GridConfig& config) {
  GridRun run(config);
  while (!run.finished()) run.cycle();
  return run.result();
}

}  // namespace screed
