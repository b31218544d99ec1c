// Lines to robots.
#include "host_sim/ground_station/link/robot_log.h"

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/candump_log.h"

namespace screed {

RobotLogCounts read_robot_log(const std::string& log,
                              const std::function<void(const RobotLogFrame&)>& take) {
  CandumpReader reader(log);
  FleetView fleet;
  RobotLogCounts counts;
  LineKind kind{};
  LoggedFrame logged;
  while (reader.next(kind, logged)) {
    if (kind == LineKind::kUnreadable) ++counts.unreadable_lines;
    if (kind != LineKind::kFrame) continue;
    LinkFrame frame;
    frame.time_us = logged.time_us;
    frame.frame = logged.frame;
    const RobotHistory* const robot = fleet.add_frame(frame);
    if (robot == nullptr) continue;
    // A log does not say which module a frame came from: the node tells robots apart.
    const RobotKey key{0, node_of(frame.frame.id)};
    take({key, *robot, frame, *find_message(frame.frame.id)});
  }
  counts.damaged_frames = fleet.damaged();
  if (fleet.robots().empty()) {
    throw InputError(log + ": holds no frame of a robot; " +
                     std::to_string(counts.unreadable_lines) + " of " +
                     std::to_string(reader.line_number()) + " lines cannot be read");
  }
  return counts;
}

}  // namespace screed
