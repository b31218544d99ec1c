// Labels of ticks.
#include "nn/slip/slip_examples.h"

namespace screed::nn {
namespace {

constexpr std::size_t kDecimation = 4;     // ticks: neighbours say much the same
constexpr std::size_t kMotionWindow = 15;  // ticks before and after, over which motion is taken
constexpr double kHeldShare = 0.3;         // share of motion below which it hardly moves
constexpr double kAmbiguousMin = 0.25;
constexpr double kAmbiguousMax = 0.4;  // what lies between is not learned

}  // namespace

Examples slip_examples(const std::vector<SlipRun>& runs) {
  Examples examples{kSlipInputs, 1, {}, {}};
  for (const SlipRun& run : runs) {
    for (std::size_t i = kMotionWindow; i + kMotionWindow < run.ticks.size(); i += kDecimation) {
      const SlipTick& tick = run.ticks[i];
      if (!tick.running || !tick.evaluated) continue;
      const double motion = travel_share(run, i - kMotionWindow, i + kMotionWindow);
      if (motion >= kAmbiguousMin && motion <= kAmbiguousMax) continue;
      for (const std::int16_t input : tick.inputs) {
        examples.in.push_back(static_cast<float>(to_value(input)));
      }
      examples.out.push_back(motion < kHeldShare ? 1.0F : 0.0F);
    }
  }
  return examples;
}

}  // namespace screed::nn
