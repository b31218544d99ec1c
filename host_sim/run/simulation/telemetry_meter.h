// What a robot hands to its radio: counted, and the last frame of each message kept. One meter a
// robot.
#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/protocol/slcan.h"
#include "hal/sample.h"
#include "host_sim/ground_station/telemetry/latest_telemetry.h"

namespace screed {

class TelemetryMeter {
 public:
  /// of the radio's serial line: nominal 57,600 baud, whatever [radio] baud says
  static constexpr double kLineBytesPerS = 5760.0;

  /// One tick's answer.
  void add(uint64_t time_us, const RobotOutput& output) {
    CanFrame frame{};
    for (int i = 0; i < output.radio_out_count; ++i) {
      if (!parser_.feed(output.radio_out[i], frame)) continue;
      if (const MessageInfo* const message = find_message(frame.id))
        latest_.add_frame(time_us, frame, *message);
    }
    bytes_ += output.radio_out_count;
    frames_ += static_cast<uint64_t>(
        std::count(output.radio_out, output.radio_out + output.radio_out_count, '\r'));
  }

  /// What the robot has said, whether it arrived or not.
  const LatestTelemetry& latest() const { return latest_; }
  /// Telemetry frames: whole SLCAN lines, each ended by a carriage return.
  uint64_t frames() const { return frames_; }
  /// Share of what the radio's line carries in so many seconds, 0..1.
  double line_share(double time_s) const {
    return static_cast<double>(bytes_) / (time_s * kLineBytesPerS);
  }

 private:
  SlcanParser parser_;
  LatestTelemetry latest_;
  uint64_t frames_ = 0;
  uint64_t bytes_ = 0;
};

}  // namespace screed
