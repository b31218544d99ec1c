// Throughput of a campaign as the user runs it: simulated hours for an hour of a processor, engine,
// start of the world and summary included. The program is that of the environment variable
// SCREED_PROGRAM, which `make bench` sets.
#include <benchmark/benchmark.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "host_sim/core/child_process.h"
#include "host_sim/grid/grid_run.h"
#include "tools/bench/require.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

constexpr int kRuns = 4;

struct Ground {
  const char* name;
  const char* experiment;
  const char* settings;
  int duration_s;  ///< some seconds of a processor for each run
};

constexpr Ground kGrounds[] = {
    {"rigid", "first_drive", "", 300},
    {"soil", "soft_bed", "", 60},
    {"soil, 5 ms", "soft_bed", "physics.step = 0.005\n", 120},
    {"particles", "gravel_bed", "", 6},
    {"surrogate", "soft_bed", "world.hal = surrogate\n", 300},
};

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

/// Of processes that have ended and been waited for.
double children_s() {
  rusage usage{};
  getrusage(RUSAGE_CHILDREN, &usage);
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

void write_campaign(const Ground& ground, const fs::path& file) {
  std::ofstream(file) << "[campaign]\nexperiment = " << ground.experiment << "\nseeds = 1.."
                      << kRuns
                      // Given, so that no trial is counted.
                      << "\ntime_limit = 3600\nmemory = 500\n[set]\nexperiment.duration = "
                      << ground.duration_s << "\n"
                      << ground.settings;
}

/// Whether the campaign in this folder ended with all runs done.
bool run_campaign_of(const fs::path& folder, const char* program) {
  return shell_output("cd '" + folder.string() + "' && '" + program +
                      "' campaign run bench.ini --workers 1 --quiet --out out")
             .exit_code == 0;
}

void campaign(benchmark::State& state) {
  const Ground& ground = kGrounds[state.range(0)];
  const char* const program = std::getenv("SCREED_PROGRAM");
  if (!require(state, program != nullptr, "SCREED_PROGRAM names no program")) return;
  const fs::path folder =
      fs::temp_directory_path() / ("screed-bench-campaign-" + std::to_string(getpid()));
  double simulated_s = 0.0;
  const double before_s = children_s();
  while (state.KeepRunning()) {
    fs::create_directories(folder);
    write_campaign(ground, folder / "bench.ini");
    const bool done = run_campaign_of(folder, program);
    fs::remove_all(folder);
    if (!require(state, done, "the campaign is not complete")) return;
    simulated_s += kRuns * ground.duration_s;
  }
  state.SetLabel(ground.name);
  state.counters["simulated_h_per_core_h"] = simulated_s / (children_s() - before_s);
}
BENCHMARK(campaign)
    ->DenseRange(0, static_cast<int>(std::size(kGrounds)) - 1)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime();

// What a cycle of an agent costs in the grid world. `per_agent_cycle` is the figure to compare.
//
// A terrain goes on being changed when it is level, but ever less; so every benchmark begins anew
// with a rough one after a while, and what it measures is the work of a run, not of its end.

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
