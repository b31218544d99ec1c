// A second robot on the samples of a first one: the core is a pure function of its state and its
// samples, so both must give the same bytes.
//
// The second one is the shadow. It also shows its thoughts (attitude, odometry, states), which the
// first one, behind its HAL or in its microcontroller, does not. One checker a robot.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "firmware/robot/robot.h"
#include "hal/sample.h"
#include "host_sim/run/world/world.h"

namespace screed {

class ParityChecker {
 public:
  /// With what the other robot was built with, so that both start in the same state.
  explicit ParityChecker(const RobotSettings& robot)
      : shadow_(robot.board, robot.parameters, robot.credentials) {}

  /// Lets the shadow answer a sample. Once a tick, before the other robot's answer is compared.
  void tick(const SensorSample& sample);

  /// The shadow as it is after its last tick.
  const Robot& shadow() const { return shadow_; }
  /// Calls of tick() so far.
  uint64_t ticks() const { return ticks_; }

  struct Difference {
    uint64_t bytes = 0;  ///< that differ, of a packed row (record.h); 0: the answers are equal
    std::string first;   ///< "duty_left: expected 12, got 15"; expected is the shadow's
  };
  /// Compares the other robot's answer to the last sample with the shadow's, byte by byte. Bytes of
  /// the radio behind the valid ones do not count.
  Difference compare(const RobotOutput& answer) const;

  /// Throws RunError that names the tick, counted from 1, and the first column that differs.
  void require_equal(const RobotOutput& answer) const;

 private:
  Robot shadow_;
  RobotOutput expected_{};  // one for all ticks, as in the main loop
  uint64_t ticks_ = 0;
};

// Parity: the image in its world, and a Robot compiled for the host, fed with the very samples that
// the image read; every output byte is compared, tick by tick.

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
