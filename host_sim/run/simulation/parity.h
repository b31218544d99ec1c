// Parity: the image in its world, and a Robot compiled for the host, fed with the very samples that
// the image read; every output byte is compared, tick by tick.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "host_sim/run/world/world.h"

namespace screed {

struct ParityResult {
  std::uint64_t ticks = 0;
  std::uint64_t driving_ticks = 0;  ///< with power on a motor: what the comparison is worth
  std::uint64_t compared_bytes = 0;
  std::uint64_t differing_bytes = 0;
  std::optional<std::uint64_t> first_difference_tick;  ///< counted from 0
  std::string first_difference;  ///< "duty_left: expected 12, got 15"; expected is the host's
  double simulated_s = 0.0;
};

/// Runs until the world's clock has passed `seconds`, or `go_on` returns false. Compares the first
/// robot, an image, with a Robot that starts with `host`: with what the image has, if the two are
/// to agree.
ParityResult run_parity(World& world, const RobotSettings& host, double seconds,
                        const std::function<bool(const ParityResult&)>& go_on);

}  // namespace screed
