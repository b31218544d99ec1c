// Somebody who sees every sample and every answer of the robots of a world, and may tamper with
// both.
#pragma once

#include <cstddef>

#include "hal/sample.h"

namespace screed {

class RobotWatch {
 public:
  virtual ~RobotWatch() = default;

  /// A robot has read its sensors, and the world stands as they saw it. Returns whether it is to
  /// answer; if not, the world stops here. What is changed in `sample` the firmware of a native
  /// robot reads so; an image has read it already.
  virtual bool on_sample(std::size_t /*robot*/, SensorSample& /*sample*/) { return true; }
  /// A robot has answered. A native one's answer goes to its motors and its radio as it is left
  /// here; an image has set its pins already.
  virtual void on_output(std::size_t /*robot*/, RobotOutput& /*output*/) {}

 protected:
  RobotWatch() = default;
  RobotWatch(const RobotWatch&) = default;
  RobotWatch& operator=(const RobotWatch&) = default;
};

}  // namespace screed
