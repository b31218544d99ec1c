// The host's side of the hardware abstraction layer: the free functions of hal.h forward to the
// current target of the thread.
//
// A target is whatever stands in for the hardware: a world of physics, a replayed log, the real
// image under an MCU simulator. Virtual functions are fine here: the host has the memory for them.
#pragma once

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "firmware/security/credentials.h"
#include "hal/sample.h"

namespace screed {
namespace hal {

class Target {
 public:
  virtual ~Target() = default;
  /// The calls of hal.h except parameters_intact(), which is true on a host.
  virtual void init() = 0;
  virtual const BoardConstants& board_constants() = 0;
  virtual const Parameters& parameters() = 0;
  virtual const Credentials& credentials() = 0;
  virtual bool wait_for_tick() = 0;
  virtual void read_sensors(SensorSample& sample) = 0;
  virtual void write_outputs(const RobotOutput& output) = 0;
};

/// Runs the firmware's main loop on this target, in this thread, until wait_for_tick() returns
/// false. Exceptions of the target pass through. Several threads may each run a robot of their own.
void run_firmware(Target& target);

}  // namespace hal
}  // namespace screed
