// A frame of a robot in the closed-form world that stands in for the physics: its motion alone, and
// with a ground that it digs.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>

#include "host_sim/standin/belt_ground.h"
#include "host_sim/standin/belt_motion.h"
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

}  // namespace
}  // namespace screed
