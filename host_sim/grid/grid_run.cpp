// Swarms, and runs of them.
#include "host_sim/grid/grid_run.h"

#include <string>
#include <utility>

#include "host_sim/core/errors.h"

namespace screed {

namespace {

/// Algorithm 3: the agents and the oracle that selects among them.
class FirstMemeticSwarm final : public SwarmOf<MemeticAgent> {
 public:
  FirstMemeticSwarm(GridWorld& world, const std::vector<GridPlace>& places,
                    const MemeticParameters& parameters, uint64_t seed)
      : SwarmOf(world, places, parameters, seed), period_(MemeticAgent::period(parameters)) {}

  void cycle(GridWorld& world) override {
    SwarmOf::cycle(world);
    if (counts().cycles % period_ == 0) select();
  }

 private:
  /// The fittest keeps its chromosome, the first of equals.
  void select() {
    size_t fittest = 0;
    for (size_t i = 1; i < size(); ++i) {
      if (agent(i).fitness().better_than(agent(fittest).fitness())) fittest = i;
    }
    for (size_t i = 0; i < size(); ++i) {
      if (i == fittest) {
        agent(i).keep();
      } else {
        agent(i).renew();
      }
    }
  }

  uint64_t period_;
};

}  // namespace

std::vector<GridPlace> random_places(const GridWorld& world, int agents, WorldRandom& random) {
  std::vector<GridPlace> free;
  free.reserve(world.cells());
  for (int y = 0; y < world.height(); ++y) {
    for (int x = 0; x < world.width(); ++x) {
      if (world.is_free(world.place(x, y))) free.push_back(world.place(x, y));
    }
  }
  // The beginning of a shuffle (Fisher and Yates).
  const auto count = static_cast<size_t>(agents);
  for (size_t i = 0; i < count; ++i) {
    const auto left = static_cast<double>(free.size() - i);
    std::swap(free[i], free[i + static_cast<size_t>(random.uniform() * left)]);
  }
  free.resize(count);
  return free;
}

std::unique_ptr<GridSwarm> make_swarm(const GridConfig& raw, GridWorld& world) {
  const GridConfig config = with_defaults(raw);
  WorldRandom random(config.seed, "grid places");
  const std::vector<GridPlace> places = random_places(world, config.agents, random);
  switch (config.algorithm) {
    case GridAlgorithm::kProbabilistic:
    case GridAlgorithm::kThreshold:
      return std::make_unique<SwarmOf<ProbabilisticAgent>>(
          world, places, probabilistic_parameters(config), config.seed);
    case GridAlgorithm::kMemetic1:
      return std::make_unique<FirstMemeticSwarm>(world, places, memetic_parameters(config),
                                                 config.seed);
    case GridAlgorithm::kMemetic2:
      return std::make_unique<SwarmOf<MemeticAgent>>(world, places, memetic_parameters(config),
                                                     config.seed);
    case GridAlgorithm::kPatient:
    case GridAlgorithm::kForager:
      return std::make_unique<SwarmOf<ForagingAgent>>(world, places, foraging_parameters(config),
                                                      config.seed);
  }
  return nullptr;
}

// A run of the grid world.

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
