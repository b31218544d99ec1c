// Counts what a robot hands to its radio. One meter a robot.
#pragma once

#include <algorithm>
#include <cstdint>

#include "hal/sample.h"

namespace screed {

class TelemetryMeter {
 public:
  /// of the radio's serial line: nominal 57,600 baud, whatever [radio] baud says
  static constexpr double kLineBytesPerS = 5760.0;

  /// One tick's answer.
  void add(const RobotOutput& output) {
    bytes_ += output.radio_out_count;
    frames_ += static_cast<uint64_t>(
        std::count(output.radio_out, output.radio_out + output.radio_out_count, '\r'));
  }

  /// Telemetry frames: whole SLCAN lines, each ended by a carriage return.
  uint64_t frames() const { return frames_; }
  /// Share of what the radio's line carries in so many seconds, 0..1.
  double line_share(double time_s) const {
    return static_cast<double>(bytes_) / (time_s * kLineBytesPerS);
  }

 private:
  uint64_t frames_ = 0;
  uint64_t bytes_ = 0;
};

}  // namespace screed
