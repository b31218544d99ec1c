// A frame of a robot in the surrogate world: pitch and roll from the height map, the network, the
// pose. Thesis 6.4: 285 us (Alexi V1) and 22,500 us (V2).
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "host_sim/core/data_folders.h"
#include "host_sim/core/random.h"
#include "host_sim/run/experiment/robot_model.h"
#include "nn/model/model_file.h"
#include "nn/surrogate/surrogate.h"
#include "nn/terrain/drive_strides.h"
#include "nn/terrain/terrain_network.h"
#include "tools/bench/require.h"

namespace screed {
namespace {

/// So many robots, spread over a bed of 10 m with 512 x 512 nodes.
void surrogate_frame(benchmark::State& state) {
  constexpr double kMoves = 1e-4;  // m and rad a frame
  const auto robots = static_cast<std::size_t>(state.range(0));
  const nn::Model model = nn::read_model(data_folders().models / "v2_forward.json");
  const HeightField ground = HeightField::from_function(
      512, 512, 0.02, true,
      [](double x, double y) { return 0.05 * std::sin(x * 1.2) * std::cos(y * 1.9); });
  nn::Surrogate surrogate(model, nn::SupportGeometry{}, robots);
  WorldRandom random(1, "bench");
  std::vector<double> left;
  std::vector<double> right;
  for (std::size_t i = 0; i < robots; ++i) {
    surrogate.set_pose(
        i, {random.uniform(-5.0, 5.0), random.uniform(-5.0, 5.0), random.uniform(-3.0, 3.0)});
    left.push_back(random.uniform(0.05, 0.2));
    right.push_back(random.uniform(0.05, 0.2));
  }
  while (state.KeepRunning()) {
    surrogate.step(ground, left, right);
    benchmark::ClobberMemory();
  }
  std::size_t moving = 0;
  for (std::size_t i = 0; i < robots; ++i) {
    const FrameMotion motion = surrogate.motion(i);
    if (std::abs(motion.forward_m) + std::abs(motion.turn_rad) > kMoves) ++moving;
  }
  require(state, moving == robots, "not every robot moves");
  state.counters["s_per_robot_frame"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * static_cast<double>(robots),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(surrogate_frame)->Arg(1)->Arg(32)->Arg(1024);

/// What the terrain network does to the ground below one robot on wheels, a stride of five frames
/// at a time.
void surrogate_ruts(benchmark::State& state) {
  constexpr double kStride_m = 0.0075;
  constexpr double kTurn_rad = 0.003;
  const Experiment experiment;
  const nn::GroundChange change =
      nn::read_terrain_network(data_folders().models / "terrain_flux.json")
          .change(make_robot_model(experiment, kDefaultBoard));
  const HeightField before = HeightField::from_function(
      2048, 2048, 0.005, true,
      [](double x, double y) { return 0.05 * std::sin(x * 1.2) * std::cos(y * 1.9); });
  HeightField ground = before;
  nn::Stride stride;
  stride.forward_m = kStride_m;
  stride.turn_rad = kTurn_rad;
  stride.track_m = {kStride_m, kStride_m};
  while (state.KeepRunning()) {
    stride.yaw_rad += kTurn_rad;
    stride.x_m += std::cos(stride.yaw_rad) * kStride_m;
    stride.y_m += std::sin(stride.yaw_rad) * kStride_m;
    change(ground, stride);
  }
  require(state, nn::compare(before, ground, ground).moved_cm3 > 0.0, "the soil does not move");
  state.counters["s_per_robot_frame"] =
      benchmark::Counter(static_cast<double>(state.iterations() * nn::kStrideFrames),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}
BENCHMARK(surrogate_ruts);

}  // namespace
}  // namespace screed
