// When to look at the ground, and when to tell.
#include "host_sim/run/simulation/progress.h"

#include "hal/sample.h"

namespace screed {
namespace {

constexpr uint64_t kProgressTicks = kTickRate_hz / 10;
constexpr uint64_t kFlatnessTicks =
    5U * uint64_t{kTickRate_hz};  // a look at the whole bed costs milliseconds

}  // namespace

void Progress::on_tick(const StopCondition& stop, double time_s, const Environment& plant) {
  if (!callback_) return;
  if (plant.is_deformable() && stop.ticks() % kFlatnessTicks == 0) {
    flatness_ = measure_.flatness(plant.terrain());
  }
  if (stop.ticks() % kProgressTicks == 0 || stop.done()) {
    callback_({stop.counted_s(time_s), stop.duration_s(), flatness_});
  }
}

}  // namespace screed
