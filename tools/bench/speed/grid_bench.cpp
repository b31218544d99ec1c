// What a cycle of an agent costs in the grid world. `per_agent_cycle` is the figure to compare.
//
// A terrain goes on being changed when it is level, but ever less; so every benchmark begins anew
// with a rough one after a while, and what it measures is the work of a run, not of its end.
#include <benchmark/benchmark.h>

#include <string>

#include "host_sim/grid/grid_run.h"
#include "tools/bench/require.h"

namespace screed {
namespace {

GridConfig config_of(GridAlgorithm algorithm, int side, int agents) {
  GridConfig config;
  config.algorithm = algorithm;
  config.noise.width = side;
  config.noise.height = side;
  config.agents = agents;
  return config;
}

/// Cycles of whole runs, 20 000 at most each; the check of the stop rule is part of a cycle.
void grid_cycle(benchmark::State& state, GridAlgorithm algorithm, int side, int agents) {
  constexpr uint64_t kLongest = 20'000;
  constexpr uint64_t kEnoughToBegin = 1000;  // cycles; by then some agent has moved a unit
  GridConfig config = config_of(algorithm, side, agents);
  auto run = std::make_unique<GridRun>(config);
  while (state.KeepRunning()) {
    run->cycle();
    if (run->finished() || run->cycles() == kLongest) {
      state.PauseTiming();
      ++config.seed;
      run = std::make_unique<GridRun>(config);
      state.ResumeTiming();
    }
  }
  const GridResult result = run->result();
  require(state, result.cycles < kEnoughToBegin || result.units > 0, "the agents move no units");
  // The inverse of a rate is a time.
  state.counters["per_agent_cycle"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * agents,
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

BENCHMARK_CAPTURE(grid_cycle, probabilistic, GridAlgorithm::kProbabilistic, 32, 8);
BENCHMARK_CAPTURE(grid_cycle, threshold, GridAlgorithm::kThreshold, 32, 8);
BENCHMARK_CAPTURE(grid_cycle, memetic_1, GridAlgorithm::kMemetic1, 32, 8);
BENCHMARK_CAPTURE(grid_cycle, memetic_2, GridAlgorithm::kMemetic2, 32, 8);
BENCHMARK_CAPTURE(grid_cycle, patient, GridAlgorithm::kPatient, 32, 8);
BENCHMARK_CAPTURE(grid_cycle, forager, GridAlgorithm::kForager, 32, 8);
/// 128 times as many cells an agent stays the same: what caches cost.
BENCHMARK_CAPTURE(grid_cycle, probabilistic_1024x1024, GridAlgorithm::kProbabilistic, 1024, 8192);

}  // namespace
}  // namespace screed
