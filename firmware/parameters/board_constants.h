// What the firmware core has to know of the board and the chassis it drives. The values stand in
// boards/<board>/board.h.
#pragma once

#include <stdint.h>

namespace screed {

struct BoardConstants {
  uint16_t count_um_q4;  ///< track travel per encoder count, 1/16 um (Rover 5: 565.5 um)
  /// uV per LSB of SensorSample::battery, a sum of eight conversions (A-Star LV: 1875/1024 mV)
  uint16_t battery_uv_per_lsb;
  uint16_t tread_mm;             ///< distance between the centre lines of the tracks
  uint16_t motor_nominal_mv;     ///< voltage at which the full-speed figure holds
  uint16_t full_speed_mm_per_s;  ///< track speed at full duty and nominal voltage, unloaded
  uint16_t hull_reach_mm;  ///< from the middle to a wall that it touches, a mean of all angles
};

/// More counts than any board's track makes in a tick (Rover 5: 4.4, Zumo: 61, at full speed):
/// beyond it is encoder noise.
constexpr int16_t kMaxTrackCounts = 100;

}  // namespace screed
