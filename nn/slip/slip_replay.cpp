#include "nn/slip/slip_replay.h"

#include <algorithm>
#include <cstdlib>

#include "host_sim/run/experiment/board_table.h"

namespace screed::nn {

void replay(const SlipDrive& drive,
            const std::function<void(std::size_t tick, const SlipWatch& watch,
                                     const ReplayedTick& what)>& on_tick) {
  SlipWatch watch(board_constants_of(kDefaultBoard).tread_mm);
  bool forgets = true;
  for (std::size_t i = 0; i < drive.ticks.size(); ++i) {
    const SlipTick& tick = drive.ticks[i];
    const bool half_done = watch.half_done();
    // Packets leave in every second tick.
    watch.tick({tick.speed_left, tick.effort_left}, {tick.speed_right, tick.effort_right},
               tick.gyro.data(), tick.accel.data(), tick.sin_pitch_q14, tick.yaw_rate, i % 2 == 0);
    const int faster = std::max(std::abs(int{tick.speed_left}), std::abs(int{tick.speed_right}));
    const bool fast = faster >= SlipWatch::kMinTrackSpeed_dmm_per_s;
    forgets = forgets || faster < SlipWatch::kStanding_dmm_per_s;
    const ReplayedTick what = {tick.running && fast, half_done && !watch.half_done() && fast,
                               forgets};
    on_tick(i, watch, what);
    if (what.concluded) forgets = false;
  }
}

std::vector<WatchTick> watch_of(const SlipDrive& drive) {
  std::vector<WatchTick> ticks;
  ticks.reserve(drive.ticks.size());
  replay(drive, [&](std::size_t /*tick*/, const SlipWatch& watch, const ReplayedTick& what) {
    ticks.push_back({what.evaluated, watch.stuck()});
  });
  return ticks;
}

}  // namespace screed::nn
