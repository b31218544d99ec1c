// `screed calibrate` stores what it found in the robot: all of it, or a message that says how much.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <ostream>
#include <string>

#include "host_sim/ground_station/calibration/imu_calibration.h"
#include "host_sim/ground_station/link/command_session.h"

namespace screed {

/// How a robot takes parameters.
struct ParameterWriter {
  /// Waits until it takes one; throws RunError or TaskStopped when it does not.
  std::function<void()> wait_until_ready;
  /// Stores one; nothing: no answer. May throw TaskStopped.
  std::function<std::optional<CommandAnswer>(uint16_t index, int32_t value)> write;
  /// "done", "refused: ...".
  std::function<std::string(const CommandAnswer& answer)> words;
};

/// Stores all parameters of the calibration, and prints a line for each. A value that is out of its
/// range is found before the first is stored. Throws RunError or TaskStopped, which say what is
/// stored then.
void store_calibration(const ImuCalibration& calibration, const ParameterWriter& robot,
                       std::ostream& out);

}  // namespace screed
