// The firmware's slip watch over a recorded drive.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "firmware/estimation/slip_watch.h"
#include "nn/slip/slip_drive.h"
#include "nn/slip/stuck_rules.h"

namespace screed::nn {

/// What the watch did in one tick.
struct ReplayedTick {
  bool evaluated;  ///< the tracks were fast enough and the robot was running
  bool concluded;  ///< a step of the network ended
  bool forgets;    ///< with concluded: the states were zeroed since the step before
};

/// Calls `on_tick` after every tick of the drive. The drives' board is the default one.
void replay(const SlipDrive& drive,
            const std::function<void(std::size_t tick, const SlipWatch& watch,
                                     const ReplayedTick& what)>& on_tick);

/// Flags of the watch with the network of this build.
std::vector<WatchTick> watch_of(const SlipDrive& drive);

}  // namespace screed::nn
