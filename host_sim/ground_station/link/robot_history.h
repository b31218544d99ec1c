// What a robot has said so far, ready to be shown: newest values, a history for curves, rates and
// losses, and what has happened in words. Knows the schema, not the link and not the screen.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/ground_station/link/link.h"
#include "host_sim/ground_station/link/text_canvas.h"
#include "host_sim/ground_station/telemetry/latest_telemetry.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {

class RobotHistory {
 public:
  /// How far back curves reach.
  static constexpr uint64_t kHistory_us = 120'000'000;
  /// Over how long rates and losses are taken.
  static constexpr uint64_t kWindow_us = 5'000'000;

  struct Sample {
    uint64_t time_us;
    std::array<uint8_t, 8> data;
    uint8_t missed;  ///< frames that were lost before this one, by the alive counter
  };

  struct Event {
    uint64_t time_us;
    CellStyle style;
    std::string words;
  };

  /// Takes a downlink frame that check_frame() found right. Times rise.
  void add_frame(const LinkFrame& frame, const MessageInfo& message);

  /// Notes something in the list of what happened.
  void note(uint64_t time_us, CellStyle style, std::string words);

  /// Newest first; empty when the message never came.
  const std::deque<Sample>& history(const MessageInfo& message) const;

  /// By "message.signal". Nothing before the message came; text() is then "-".
  std::optional<double> value(std::string_view path) const;
  std::optional<int64_t> raw(std::string_view path) const;
  std::string text(std::string_view path) const;

  /// Oldest first, x in seconds before now (negative), those of the last `window_s`.
  std::vector<CurvePoint> curve(const SignalRef& place, uint64_t now_us, double window_s) const;

  /// The faults of the heartbeat in words; of a disarmed robot those that would prevent arming.
  std::vector<std::string> faults() const;
  /// Why it cannot be armed now, in words; as arming_obstacles().
  std::vector<std::string> obstacles(uint64_t now_us) const;
  /// The newest frame of each message, and the parameters that were reported.
  const LatestTelemetry& latest() const { return latest_; }

  double rate_hz(const MessageInfo& message, uint64_t now_us) const;
  double frames_per_s(uint64_t now_us) const;
  /// Share of frames that were sent and did not arrive, in percent; nothing without frames.
  std::optional<double> loss_percent(uint64_t now_us) const;

  uint64_t frames() const { return frames_; }
  uint64_t lost() const { return lost_; }
  uint64_t last_us() const { return last_us_; }
  std::optional<int> rssi_dbm() const { return rssi_dbm_; }
  const std::deque<Event>& events() const { return events_; }  ///< newest first

 private:
  void note_flags(const MessageInfo& heartbeat, const Sample* before, const Sample& now);
  void look_for_changes(const MessageInfo& message, const Sample* before, const Sample& now);

  LatestTelemetry latest_;
  std::map<uint16_t, std::deque<Sample>> samples_;
  std::deque<Event> events_;
  uint64_t frames_ = 0;
  uint64_t lost_ = 0;
  uint64_t first_us_ = 0;
  uint64_t last_us_ = 0;
  std::optional<int> rssi_dbm_;
};

/// Which robot: the address of its module (0: not known), and its node.
struct RobotKey {
  uint64_t address = 0;
  uint8_t node = 1;
  auto operator<=>(const RobotKey&) const = default;
  std::string text() const;  ///< "robot 1", "robot 1 at 0013A20040522BAA"
};

/// All robots heard on a link.
class FleetView {
 public:
  /// Sorts a frame to its robot; a frame that is damaged or unknown is counted. Returns the robot
  /// it belongs to, or null: damaged, or of the ground.
  RobotHistory* add_frame(const LinkFrame& frame);

  /// The first robot of a node; null when it was not heard.
  const RobotHistory* robot(uint8_t node) const;
  const std::map<RobotKey, RobotHistory>& robots() const { return robots_; }
  std::map<RobotKey, RobotHistory>& robots() { return robots_; }
  /// Frames that the schema's check refused.
  uint64_t damaged() const { return damaged_; }
  uint64_t unknown() const { return unknown_; }
  /// Frames of ground stations, as others on the bus see them.
  uint64_t uplink() const { return uplink_; }

 private:
  std::map<RobotKey, RobotHistory> robots_;
  uint64_t damaged_ = 0;
  uint64_t unknown_ = 0;
  uint64_t uplink_ = 0;
};

// Reads a telemetry log robot by robot.

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
