// Replay of the watch, and labels.
#include "nn/slip/slip_sequence.h"

#include <algorithm>
#include <cmath>

#include "hal/sample.h"
#include "nn/slip/slip_replay.h"

namespace screed::nn {
namespace {

constexpr std::size_t kMotionWindow = 15;  // ticks before and after, over which motion is taken
constexpr double kHeldMax = 0.25;
constexpr double kFreeMin = 0.4;
constexpr std::size_t kShareWindow = kTickRate_hz / 2;

}  // namespace

std::vector<SlipStep> slip_steps(const SlipDrive& drive, const TrueMotion& motion) {
  std::vector<SlipStep> steps;
  replay(drive, [&](std::size_t i, const SlipWatch& watch, const ReplayedTick& what) {
    if (!what.concluded) return;
    const SlipTick& tick = drive.ticks[i];
    SlipStep step{};
    std::copy_n(watch.network_inputs(), kSlipInputs, step.inputs.begin());
    step.tick = static_cast<std::uint32_t>(i);
    step.forgets = what.forgets;
    if (tick.running) {
      const double share =
          motion.travel_share(i > kMotionWindow ? i - kMotionWindow : 0, i + kMotionWindow);
      const double before = motion.travel_share(i > kShareWindow ? i - kShareWindow : 0, i + 1);
      const bool free = share > kFreeMin || before > kFreeShare;
      step.held = !free && share < kHeldMax ? 1.0F : 0.0F;
      step.held_weight = free || share < kHeldMax ? 1.0F : 0.0F;
      const auto forward = motion.forward_share(i > kShareWindow ? i - kShareWindow : 0, i);
      step.share = static_cast<float>(forward.share);
      step.share_weight =
          static_cast<float>(forward.belts_m * kTickRate_hz / static_cast<double>(kShareWindow));
    }
    steps.push_back(step);
  });
  return steps;
}

}  // namespace screed::nn
