// Position fixes as an overhead camera makes them: late by nothing, with noise, and missing during
// outages.
#pragma once

#include <cstdint>
#include <optional>

#include "firmware/protocol/messages.h"
#include "host_sim/core/random.h"

namespace screed {

struct PositionFixOptions {
  double period_s = 0.0;        ///< 0: no fixes; else rounded to 0.25 s, at least that
  double sigma_m = 0.02;        ///< standard deviation along each axis
  double outage_every_s = 0.0;  ///< mean time from an outage to the next one; 0: none
  double outage_s = 10.0;       ///< length of each
};

class PositionFixes {
 public:
  PositionFixes(std::uint64_t seed, const PositionFixOptions& options);

  /// The argument of CommandOp::kPositionFix (cm) for a robot at (x, y), when one is due in this
  /// tick (of 10 ms, counted from 0) and no outage hides it. To be asked every tick.
  std::optional<DriveArgument> at(std::uint64_t tick, double x_m, double y_m);

 private:
  double next_outage_s();

  PositionFixOptions options_;
  std::uint64_t period_ticks_;
  WorldRandom random_;
  WorldRandom outages_;
  double outage_begins_s_;
};

}  // namespace screed
