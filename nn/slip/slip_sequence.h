// Drives as the slip watch's network meets them: its inputs step by step, and what it is to say.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/estimation/slip_watch.h"
#include "nn/slip/slip_drive.h"
#include "nn/slip/stuck_rules.h"

namespace screed::nn {

/// One step of the network, every fourth tick in which it runs.
struct SlipStep {
  std::array<std::int8_t, kSlipInputs> inputs;
  std::uint32_t tick;  ///< at which the answer is known
  bool forgets;        ///< the tracks stood since the step before: the states are zero again
  float held;          ///< 1: it hardly moves, 0: it moves
  float held_weight;   ///< 0: unclear, teaches nothing; else 1
  float share;         ///< of the belts' travel over the last half second that the chassis made
  float share_weight;  ///< the belts' mean speed over that time, m/s; 0: it teaches nothing
};

/// Steps of a drive: those inputs that the firmware's slip watch makes of it. Held is a robot that
/// makes less than 0.25 of the tracks' travel in the 15 ticks before and after, free one that makes
/// more than 0.4.
std::vector<SlipStep> slip_steps(const SlipDrive& drive, const TrueMotion& motion);

}  // namespace screed::nn
