// What a robot costs in company: runs of one and of four robots on soil and on rigid ground.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation.h"
#include "paths.h"
#include "tools/bench/require.h"

namespace screed {
namespace {

/// A run with session and pictures, of so many robots. robot_real_time_factor is simulated time of
/// all robots over processor time: what a robot costs is its inverse.
void robots_run(benchmark::State& state, const char* name) {
  constexpr double kDuration_s = 60.0;
  const auto count = static_cast<uint32_t>(state.range(0));
  Experiment experiment = read_experiment(std::filesystem::path(kDataFolder) / "experiments" /
                                          (std::string(name) + ".ini"));
  experiment.experiment.duration_s = kDuration_s;
  experiment.robots.count = count;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("screed-robots-bench-" + std::to_string(getpid()));
  double simulated_s = 0.0;
  while (state.KeepRunning()) {
    SimulationOptions options;
    options.out = folder;
    options.table = false;
    const SimulationSummary summary = run_simulation(experiment, options);
    std::filesystem::remove_all(folder);
    if (!require(state, summary.time_s == kDuration_s, "the run ended early")) break;
    simulated_s += count * summary.time_s;
  }
  state.counters["robot_real_time_factor"] =
      benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(robots_run, soil, "soft_bed")->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(robots_run, rigid, "first_drive")->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace screed
