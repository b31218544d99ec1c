// `make bench`: how fast the twin is. Each figure is also a ratio to simulated time, since machines
// differ and are shared.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation.h"
#include "host_sim/standin/standin_plant.h"
#include "paths.h"
#include "tools/bench/require.h"
#include "tools/bench/speed/timed_drive.h"

namespace screed {
namespace {

Experiment first_drive() {
  return read_experiment(std::filesystem::path(kDataFolder) / "experiments" / "first_drive.ini");
}

/// A robot that has begun to drive, and the samples of the minute that follows.
struct RecordedDrive {
  Robot robot;
  std::vector<SensorSample> samples;
};

const RecordedDrive& recorded_drive() {
  static const RecordedDrive recorded = [] {
    TimedDrive drive(first_drive());
    RecordedDrive result{drive.robot(), {}};
    for (int i = 0; i < 60 * kTickRate_hz; ++i) {
      drive.tick();
      result.samples.push_back(drive.sample());
    }
    return result;
  }();
  return recorded;
}

constexpr const char* kDoesNotRun = "the robot is not running at the end";

/// One tick of the firmware core on the host, of a robot that is running. The samples come from a
/// real run, so that the firmware takes the branches it takes when driving; each time through them
/// begins with the robot they belong to, since to any other the counts of its encoders would jump.
void firmware_tick(benchmark::State& state) {
  const RecordedDrive& recorded = recorded_drive();
  Robot robot = recorded.robot;
  RobotOutput output{};
  size_t next = 0;
  while (state.KeepRunning()) {
    robot.tick(recorded.samples[next], output);
    benchmark::DoNotOptimize(output);
    if (++next < recorded.samples.size()) continue;
    state.PauseTiming();
    if (!require(state, TimedDrive::is_running(robot), kDoesNotRun)) break;
    robot = recorded.robot;
    next = 0;
    state.ResumeTiming();
  }
  require(state, TimedDrive::is_running(robot), kDoesNotRun);
}
BENCHMARK(firmware_tick);

Experiment on_soil(double cell_m) {
  Experiment experiment = first_drive();
  experiment.map.model = "scm";
  experiment.soil.cell_m = cell_m;
  return experiment;
}

WorldChoice stand_in() {
  WorldChoice choice;
  choice.hal = "surrogate";
  return choice;
}

/// One control tick of a world with the running robot in it: ten steps of 1 ms, sensors, radio,
/// firmware.
void world_tick(benchmark::State& state, const Experiment& experiment, const WorldChoice& choice) {
  auto drive = std::make_unique<TimedDrive>(experiment, choice);
  while (state.KeepRunning()) {
    drive->tick();
    if (!drive->is_over()) continue;
    state.PauseTiming();
    if (!require(state, TimedDrive::is_running(drive->robot()), kDoesNotRun)) break;
    drive = std::make_unique<TimedDrive>(experiment, choice);
    state.ResumeTiming();
  }
  require(state, TimedDrive::is_running(drive->robot()), kDoesNotRun);
  state.counters["real_time_factor"] = benchmark::Counter(
      static_cast<double>(state.iterations()) / kTickRate_hz, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(world_tick, rigid, first_drive(), WorldChoice{});
BENCHMARK_CAPTURE(world_tick, soil, on_soil(0.01), WorldChoice{});
BENCHMARK_CAPTURE(world_tick, stand_in, on_soil(kStandInCell_m), stand_in());

/// `screed sim` as the user runs it: 300 s with session, telemetry log, tables and pictures.
/// real_time_factor counts the loop with recording, as the program prints it;
/// whole_real_time_factor everything.
void recorded_run(benchmark::State& state) {
  constexpr double kDuration_s = 300.0;
  Experiment experiment = first_drive();
  experiment.experiment.duration_s = kDuration_s;
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("screed-bench-" + std::to_string(getpid()));
  double simulated = 0.0;
  double wall = 0.0;
  while (state.KeepRunning()) {
    SimulationOptions options;
    options.out = folder;
    const SimulationSummary summary = run_simulation(experiment, options);
    if (!require(state, summary.state == "running" && summary.time_s == kDuration_s, kDoesNotRun)) {
      std::filesystem::remove_all(folder);
      break;
    }
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

bool all_hold = true;

}  // namespace

bool require(benchmark::State& state, bool holds, const char* error) {
  if (!holds) {
    all_hold = false;
    state.SkipWithError(error);
  }
  return holds;
}

}  // namespace screed

// BENCHMARK_MAIN() ends with 0 whatever the benchmarks say of themselves, and when none is run.
int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const size_t run = benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return run > 0 && screed::all_hold ? 0 : 1;
}
