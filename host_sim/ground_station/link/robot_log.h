// Reads a telemetry log robot by robot.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "host_sim/ground_station/link/robot_history.h"

namespace screed {

/// A sound frame of a robot, whose history has taken it already.
struct RobotLogFrame {
  const RobotKey& key;
  const RobotHistory& robot;
  const LinkFrame& frame;
  const MessageInfo& message;
};

struct RobotLogCounts {
  uint64_t unreadable_lines = 0;
  uint64_t damaged_frames = 0;
};

/// Hands every frame of a robot in the log to `take`, in their order, which is that of time in what
/// candump, `screed monitor` and `screed drive` write. "-" is standard input. Throws InputError,
/// naming the log, when it cannot be read or holds no frame of a robot.
RobotLogCounts read_robot_log(const std::string& log,
                              const std::function<void(const RobotLogFrame&)>& take);

}  // namespace screed
