// A frame of a robot in worlds that stand in for the physics. In closed form: its motion alone, and
// with a ground that it digs.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "host_sim/core/data_folders.h"
#include "host_sim/core/random.h"
#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/standin/belt_ground.h"
#include "host_sim/standin/belt_motion.h"
#include "nn/model/model_file.h"
#include "nn/surrogate/surrogate.h"
#include "nn/terrain/drive_strides.h"
#include "nn/terrain/terrain_network.h"
#include "tools/bench/require.h"

namespace screed {
namespace {

/// Speeds of the belts, m/s: to and fro, in arcs.
std::array<double, 2> speeds_at(std::int64_t frame) {
  const double to_and_fro = frame / 300 % 2 == 0 ? 1.0 : -1.0;
  return {0.12 * to_and_fro, 0.16 * to_and_fro};
}

void report(benchmark::State& state, std::int64_t frames) {
  state.counters["s_per_robot_frame"] = benchmark::Counter(
      static_cast<double>(frames), benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void standin_motion(benchmark::State& state) {
  const TrackGeometry tracks;
  BeltMotion belts(tracks, soil_preset("gravel"));
  BeltSupport support = level_support(tracks);
  support.forward = 0.1;
  PlanarPose pose;
  for (int i = 0; i < 100; ++i) belts.step(0.12, 0.16, support);  // until it drives
  double distance_m = 0.0;
  std::int64_t frame = 0;
  while (state.KeepRunning()) {
    const auto [left, right] = speeds_at(frame++);
    const FrameMotion motion = belts.step(left, right, support);
    pose.move(motion);
    distance_m += std::abs(motion.forward_m);
  }
  benchmark::DoNotOptimize(pose);
  require(state, distance_m > 5e-4 * static_cast<double>(frame), "the robot does not drive");
  report(state, frame);
}
BENCHMARK(standin_motion);

void standin_ground(benchmark::State& state) {
  const TrackGeometry tracks;
  const SoilParameters soil = soil_preset("gravel");
  const HeightField bed = HeightField::from_function(150, 150, 0.02, true, [](double x, double y) {
    return 0.02 * std::sin(x * 4.0) * std::cos(y * 6.0);
  });
  BeltGround ground(bed, soil, tracks, 1);
  BeltMotion belts(tracks, soil);
  PlanarPose pose;
  ground.place(0, pose);
  BeltStrideRecorder stride(pose);
  std::int64_t frame = 0;
  while (state.KeepRunning()) {
    const auto [left, right] = speeds_at(frame++);
    const FrameMotion motion = belts.step(left, right, ground.support(0));
    pose.move(motion);
    stride.add_frame(motion, belts.shear());
    if (frame % kBeltStrideFrames == 0) {
      ground.press(0, stride.take(pose));
      ground.end_stride();
    }
  }
  const VolumeBalance balance = ground.balance();
  require(state, balance.error() == 0, "volume is lost");
  require(state, balance.compacted > 0, "nothing is dug");
  report(state, frame);
}
BENCHMARK(standin_ground);

// A frame of a robot in the surrogate world: pitch and roll from the height map, the network, the
// pose. Thesis 6.4: 285 us (Alexi V1) and 22,500 us (V2).

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
