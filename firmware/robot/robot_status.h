// State that the robot keeps from tick to tick and that supervisor, leveling and drive share.
// Telemetry only reads it.
#pragma once

#include <stdint.h>

#include "firmware/control/drive_control.h"
#include "firmware/estimation/attitude.h"
#include "firmware/estimation/place.h"
#include "firmware/robot/supervisor.h"

namespace screed {

struct RobotStatus {
  // Pose: asked for once a tick, since on the AVR an angle costs 1500 cycles and a deviation a
  // root.
  AttitudeAngles angles;
  Place place;
  uint16_t battery_mv;
  MotionCommand motion;  ///< commanded
  DriveOutput duty;      ///< motor duty; the last tick's until drive control has run
  RobotState state;      ///< of the supervisor at the end of a tick
};

/// What came from the ground station; counts wrap.
struct UplinkCounts {
  uint8_t ground_heartbeats;  ///< valid ones since start
  uint16_t ground_time_ms;    ///< lower 16 bits of the last one's time
  /// well-formed frames for this robot; a COMMAND counts before its MAC is checked
  uint16_t frames_received;
  uint8_t rejected_frames;  ///< wrong CRC or size, or a COMMAND while another waits
};

}  // namespace screed
