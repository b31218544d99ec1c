// The host's side of the hardware abstraction layer: the free functions of hal.h forward to the
// current target of the thread.
//
// A target is whatever stands in for a robot's hardware: a robot of a simulated world, or a test.
// (The flash image under the MCU simulator has the real HAL.) Virtual functions are fine here: the
// host has the memory for them.
#pragma once

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "firmware/security/command_mac.h"
#include "hal/sample.h"

namespace screed {
namespace hal {

class Target {
 public:
  virtual ~Target() = default;
  /// The calls of hal.h except parameters_intact(), which is true on a host. The first and
  /// wait_for_tick() are for targets that main_loop() runs on; where a world says when a tick is
  /// due, it calls tick_firmware().
  virtual void init() {}
  virtual const BoardConstants& board_constants() = 0;
  virtual const Parameters& parameters() = 0;
  virtual const Credentials& credentials() = 0;
  virtual bool wait_for_tick() { return false; }
  virtual void read_sensors(SensorSample& sample) = 0;
  virtual void write_outputs(const RobotOutput& output) = 0;
};

/// While it lives, this thread's calls of hal.h go to this target; after it to the one before.
/// Threads may each run robots of their own, and one thread several in turn.
class TargetScope {
 public:
  explicit TargetScope(Target& target);
  ~TargetScope();
  TargetScope(const TargetScope&) = delete;
  TargetScope& operator=(const TargetScope&) = delete;

 private:
  Target* before_;
};

}  // namespace hal
}  // namespace screed
