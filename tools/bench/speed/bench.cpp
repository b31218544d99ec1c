// `make bench`: how fast the twin is. Each figure is also a ratio to simulated time, since machines
// differ and are shared.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "boards/a_star_32u4/board.h"
#include "firmware/robot/robot.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation.h"
#include "paths.h"

namespace screed {
namespace {

Experiment first_drive() {
  return read_experiment(std::filesystem::path(kDataFolder) / "experiments" / "first_drive.ini");
}

/// Samples of a real run, so that the firmware takes the ways it takes when driving.
const std::vector<SensorSample>& recorded_samples() {
  static const std::vector<SensorSample> samples = [] {
    const Experiment experiment = first_drive();
    const std::unique_ptr<World> world = make_world(experiment, nullptr);
    Robot robot(kBoard, experiment.parameters, credentials_of(experiment));
    RobotOutput output{};
    std::vector<SensorSample> recorded;
    for (int i = 0; i < 60 * kTickRate_hz; ++i) {
      world->advance();
      recorded.push_back(world->sample());
      robot.tick(world->sample(), output);
      world->apply(output);
    }
    return recorded;
  }();
  return samples;
}

/// One tick of the firmware core on the host.
void firmware_tick(benchmark::State& state) {
  const std::vector<SensorSample>& samples = recorded_samples();
  Robot robot(kBoard, first_drive().parameters, credentials_of(test_key()));
  RobotOutput output{};
  size_t next = 0;
  while (state.KeepRunning()) {
    robot.tick(samples[next], output);
    benchmark::DoNotOptimize(output);
    next = next + 1 == samples.size() ? 0 : next + 1;
  }
}
BENCHMARK(firmware_tick);

/// One control tick of the world with the robot in it: ten physics steps of 1 ms, sensors, radio,
/// firmware.
void world_tick(benchmark::State& state) {
  const Experiment experiment = first_drive();
  const std::unique_ptr<World> world = make_world(experiment, nullptr);
  Robot robot(kBoard, experiment.parameters, credentials_of(experiment));
  RobotOutput output{};
  while (state.KeepRunning()) {
    world->advance();
    robot.tick(world->sample(), output);
    world->apply(output);
  }
  state.counters["real_time_factor"] = benchmark::Counter(
      static_cast<double>(state.iterations()) / kTickRate_hz, benchmark::Counter::kIsRate);
}
BENCHMARK(world_tick);

/// `screed sim` as the user runs it: 300 s with session, telemetry log, tables and pictures.
/// real_time_factor counts the loop with recording, as the program prints it;
/// whole_real_time_factor everything.
void recorded_run(benchmark::State& state) {
  Experiment experiment = first_drive();
  experiment.experiment.duration_s = 300.0;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("screed-bench-" + std::to_string(getpid()));
  double simulated = 0.0;
  double wall = 0.0;
  while (state.KeepRunning()) {
    SimulationOptions options;
    options.out = folder;
    const SimulationSummary summary = run_simulation(experiment, options);
    simulated += summary.time_s;
    wall += summary.wall_s;
    state.PauseTiming();
    std::filesystem::remove_all(folder);
    state.ResumeTiming();
  }
  state.counters["real_time_factor"] = simulated / wall;
  state.counters["whole_real_time_factor"] =
      benchmark::Counter(simulated, benchmark::Counter::kIsRate);
}
BENCHMARK(recorded_run)->Unit(benchmark::kMillisecond)->Iterations(3)->UseRealTime();

}  // namespace
}  // namespace screed

BENCHMARK_MAIN();
