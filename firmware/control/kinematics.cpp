// Kinematics of a skid-steer robot (thesis 5.1.2).
#include "firmware/control/kinematics.h"

namespace screed {

TrackSpeeds SkidSteer::tracks(int16_t speed_mm_per_s, int32_t yaw_rate,
                              int16_t limit_mm_per_s) const {
  const int16_t rate = limit_i16(yaw_rate, INT16_MAX);
  const int16_t turn =
      limit_i16(asr_round(detail::mul_su(rate, half_arc_q22_), 22), limit_mm_per_s);
  const auto room = static_cast<int16_t>(limit_mm_per_s - static_cast<int16_t>(abs_i16(turn)));
  const int16_t speed = limit_i16(speed_mm_per_s, room);
  return {static_cast<int16_t>(speed - turn), static_cast<int16_t>(speed + turn)};
}

}  // namespace screed
