// The downlink: which frame is due when, and its bytes. At most two lines a tick, so that the
// radio's 57.6 bytes a tick hold them.
#pragma once

#include <stdint.h>

#include "firmware/leveling/leveling.h"
#include "firmware/robot/supervisor.h"
#include "firmware/telemetry/messages.h"
#include "hal/sample.h"

namespace screed {

/// Everything the downlink may say, gathered by the robot each tick.
struct TelemetryView {
  const SensorSample* sample;
  int16_t roll_cdeg;
  int16_t pitch_cdeg;
  uint16_t heading_cdeg;  ///< 0..35999
  int32_t x_mm;
  int32_t y_mm;
  int16_t duty_left;
  int16_t duty_right;
  MotionCommand motion;
  RobotState state;
  uint16_t faults;
  bool link_alive;
  uint8_t rejected_lines;
  LevelingAlgorithm algorithm;
  LevelingState leveling_state;
  uint16_t peaks;
  uint16_t battery_mv;
};

constexpr uint8_t kTelemetryMessages = 13;

class Telemetry {
 public:
  /// Queues the acknowledgement of a command for the next tick; a second one before that replaces
  /// it.
  void acknowledge(uint8_t op, RequestResult result);

  /// One tick: writes the lines that are due into output.radio_out, whole lines only. What does not
  /// fit waits for the next tick.
  void tick(const TelemetryView& view, RobotOutput& output);

 private:
  void emit(CanFrame& frame, uint8_t& counter, RobotOutput& output);

  uint16_t due_ = 0;  ///< a bit a message: it waits for room
  uint8_t countdown_[kTelemetryMessages] = {};
  uint8_t counter_[kTelemetryMessages] = {};
  bool started_ = false;
  uint8_t ack_counter_ = 0;
  uint8_t ack_op_ = 0;  ///< 0: nothing to acknowledge
  RequestResult ack_result_ = RequestResult::kDone;
};

}  // namespace screed
