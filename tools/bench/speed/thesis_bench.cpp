// A frame of the thesis' two worlds (6.4), physics and networks, with firmware and
// sensors, without recording: V1's tracks on particles that never move, V2's wheels on soil that
// they change. The argument: the side of the terrain as a multiple of the one that was trained on.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "host_sim/core/data_folders.h"
#include "host_sim/run/experiment/experiment.h"
#include "paths.h"
#include "tools/bench/require.h"
#include "tools/bench/speed/timed_drive.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

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

}  // namespace
}  // namespace screed
