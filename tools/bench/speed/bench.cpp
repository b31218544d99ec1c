// `make bench`: how fast the twin is. Each figure is also a ratio to simulated time, since machines
// differ and are shared.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "firmware/robot/robot.h"
#include "host_sim/core/data_folders.h"
#include "host_sim/core/errors.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation.h"
#include "host_sim/standin/standin_plant.h"
#include "paths.h"
#include "tools/bench/require.h"
#include "tools/screed/cli/world_choice.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

/// A world with its robot, which is running, tick by tick and without any recording.
class TimedDrive {
 public:
  explicit TimedDrive(const Experiment& experiment, const WorldChoice& choice = {})
      : experiment_(experiment),
        world_(make_world(experiment_, {.environment = environment_of(choice)})) {
    constexpr uint64_t kLongestStart = 20U * uint64_t{kTickRate_hz};
    while (!is_running(robot())) {
      if (world_->ticks() > kLongestStart) throw RunError("the robot does not begin to drive");
      tick();
    }
  }

  static bool is_running(const Robot& robot) {
    return robot.supervisor().state() == RobotState::kRunning;
  }

  void tick() { world_->advance(); }

  static EnvironmentFactory environment_of(const WorldChoice& choice) {
    SimulationOptions options;
    choose_world(choice, options);
    return options.environment;
  }

  bool is_over() const {
    return static_cast<double>(world_->ticks()) >= experiment_.experiment.duration_s * kTickRate_hz;
  }
  const Robot& robot() const { return world_->firmware(); }
  Eigen::Vector3d place() const { return world_->plant().robot(0).unwrapped_position(); }
  /// Of the last tick.
  const SensorSample& sample() const { return world_->sample(); }

 private:
  Experiment experiment_;
  std::unique_ptr<World> world_;
};

Experiment first_drive() {
  return read_experiment(fs::path(kDataFolder) / "experiments" / "first_drive.ini");
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
  const fs::path folder = fs::temp_directory_path() / ("screed-bench-" + std::to_string(getpid()));
  double simulated = 0.0;
  double wall = 0.0;
  while (state.KeepRunning()) {
    SimulationOptions options;
    options.out = folder;
    const SimulationSummary summary = run_simulation(experiment, options);
    if (!require(state, summary.state == "running" && summary.time_s == kDuration_s, kDoesNotRun)) {
      fs::remove_all(folder);
      break;
    }
    simulated += summary.time_s;
    wall += summary.wall_s;
    state.PauseTiming();
    fs::remove_all(folder);
    state.ResumeTiming();
  }
  state.counters["real_time_factor"] = simulated / wall;
  state.counters["whole_real_time_factor"] =
      benchmark::Counter(simulated, benchmark::Counter::kIsRate);
}
BENCHMARK(recorded_run)->Unit(benchmark::kMillisecond)->Iterations(3)->UseRealTime();

// A frame of the thesis' two worlds (6.4), physics and networks, with firmware and
// sensors, without recording: V1's tracks on particles that never move, V2's wheels on soil that
// they change. The argument: the side of the terrain as a multiple of the one that was trained on.

/// `model`: the network that moves the robot, "": the physics does. `terrain_net`: the one that
/// changes the ground, "": it stays as it is, or as the physics has it.
void thesis_frame(benchmark::State& state, const char* session, const std::string& model,
                  const std::string& terrain_net) {
  constexpr int kFrames = 1000;  // an iteration
  Experiment experiment = read_experiment(fs::path(kDataFolder) / "experiments" / "sessions" /
                                          (std::string(session) + ".ini"));
  const auto scale = static_cast<double>(state.range(0));
  experiment.map.size_m *= scale;
  experiment.map.scale_m *= scale;
  WorldChoice choice;
  if (!model.empty()) {
    choice.hal = "surrogate";
    choice.model = (data_folders().models / model).string();
  }
  if (!terrain_net.empty()) choice.terrain_net = (data_folders().models / terrain_net).string();
  TimedDrive drive(experiment, choice);
  const Eigen::Vector3d begin = drive.place();
  double farthest_m = 0.0;
  while (state.KeepRunning()) {
    for (int i = 0; i < kFrames; ++i) drive.tick();
    farthest_m = std::max(farthest_m, (drive.place() - begin).norm());
  }
  require(state, TimedDrive::is_running(drive.robot()), "the robot is not running at the end");
  require(state, farthest_m > 0.05, "the robot does not drive");
  state.counters["s_per_frame"] =
      benchmark::Counter(static_cast<double>(state.iterations() * kFrames),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
  // Of all threads together.
  state.counters["frames_per_s"] = benchmark::Counter(
      static_cast<double>(state.iterations() * kFrames), benchmark::Counter::kIsRate);
}
void sizes(benchmark::internal::Benchmark* one) {
  one->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(thesis_frame, v1_physics, "v1_test", "", "")->Apply(sizes);
BENCHMARK_CAPTURE(thesis_frame, v1_network, "v1_test", "v1.json", "")->Apply(sizes);
/// A world on each of two processors.
BENCHMARK_CAPTURE(thesis_frame, v1_network_twice, "v1_test", "v1.json", "")
    ->Arg(1)
    ->Threads(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(thesis_frame, v2_physics, "v2_b_test", "", "")->Apply(sizes);
BENCHMARK_CAPTURE(thesis_frame, v2_network, "v2_b_test", "v2.json", "")->Apply(sizes);
BENCHMARK_CAPTURE(thesis_frame, v2_network_and_ground, "v2_b_test", "v2.json", "terrain_flux.json")
    ->Apply(sizes);

// What a robot costs in company: runs of one and of four robots on soil and on rigid ground.

/// A run with session and pictures, of so many robots. robot_real_time_factor is simulated time of
/// all robots over processor time: what a robot costs is its inverse.
void robots_run(benchmark::State& state, const char* name) {
  constexpr double kDuration_s = 60.0;
  const auto count = static_cast<uint32_t>(state.range(0));
  Experiment experiment =
      read_experiment(fs::path(kDataFolder) / "experiments" / (std::string(name) + ".ini"));
  experiment.experiment.duration_s = kDuration_s;
  experiment.robots.count = count;
  const fs::path folder =
      fs::temp_directory_path() / ("screed-robots-bench-" + std::to_string(getpid()));
  double simulated_s = 0.0;
  while (state.KeepRunning()) {
    SimulationOptions options;
    options.out = folder;
    options.table = false;
    const SimulationSummary summary = run_simulation(experiment, options);
    fs::remove_all(folder);
    if (!require(state, summary.time_s == kDuration_s, "the run ended early")) break;
    simulated_s += count * summary.time_s;
  }
  state.counters["robot_real_time_factor"] =
      benchmark::Counter(simulated_s, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(robots_run, soil, "soft_bed")->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(robots_run, rigid, "first_drive")->Arg(1)->Arg(4)->Unit(benchmark::kMillisecond);

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
