// When to tell.
#include "host_sim/run/simulation/progress.h"

#include "hal/sample.h"

namespace screed {
namespace {

constexpr uint64_t kProgressTicks = kTickRate_hz / 10;

}  // namespace

void Progress::on_leveling(const LevelingPoint& point) {
  now_m_ = point.level_deviation;
  if (!before_m_.has_value()) before_m_ = now_m_;
}

void Progress::on_tick(const StopCondition& stop, double time_s) const {
  if (!callback_) return;
  if (stop.ticks() % kProgressTicks == 0 || stop.done())
    callback_({stop.counted_s(time_s), stop.duration_s(), before_m_.value_or(0.0), now_m_});
}

}  // namespace screed
