// A supervisor and the robot that it watches, as tests of it want it: well until a test says
// otherwise.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "firmware/robot/supervisor.h"

namespace screed {

class SupervisedRobot {
 public:
  explicit SupervisedRobot(const Parameters& given = {}) : parameters(given) {}

  /// One tick with the ground station heard.
  void tick() {
    if (heard) supervisor.heartbeat();
    silent_tick();
  }
  void silent_tick() {
    if (!gyro_frozen) gyro[2] = gyro[2] == 0 ? 1 : 0;  // the noise of its last digit
    SupervisorInput input = {fresh,     gyro,       accel,       cos_tilt_q14, ready, battery_mv,
                             duty_left, duty_right, counts_left, counts_right, 0,     stuck};
    input.attitude_known = attitude_known;
    input.gave_up = gave_up;
    input.slips_on_purpose = slips_on_purpose;
    supervisor.tick(parameters, input);
  }
  /// Ticks until the robot has left the state, at most `most`.
  int ticks_in(RobotState state, int most) {
    int ticks = 0;
    while (supervisor.state() == state && ticks < most) {
      tick();
      ++ticks;
    }
    return ticks;
  }
  void bring_to(RobotState state) {
    tick();
    if (state == RobotState::kDisarmed) return;
    if (state == RobotState::kFault) {
      supervisor.request(Request::kEmergencyStop);
      return;
    }
    supervisor.request(Request::kArm);
    if (state == RobotState::kArmed) return;
    supervisor.request(Request::kRun);
    if (state == RobotState::kStopped) supervisor.request(Request::kStop);
  }
  void roll_to(double degrees) {
    const double angle = degrees * std::numbers::pi / 180.0;
    accel[1] = static_cast<int16_t>(std::lround(4098.0 * std::sin(angle)));
    accel[2] = static_cast<int16_t>(std::lround(4098.0 * std::cos(angle)));
  }

  Parameters parameters;
  Supervisor supervisor;
  bool heard = true;
  uint8_t fresh = kFreshGyro | kFreshAccel;
  int16_t gyro[3] = {0, 0, 0};
  bool gyro_frozen = false;
  int16_t accel[3] = {0, 0, 4098};
  int16_t cos_tilt_q14 = 16384;
  bool ready = true;
  bool attitude_known = true;
  uint16_t battery_mv = 7200;
  int16_t duty_left = 0;
  int16_t duty_right = 0;
  int16_t counts_left = 0;
  int16_t counts_right = 0;
  bool stuck = false;
  bool gave_up = false;
  bool slips_on_purpose = false;
};

}  // namespace screed
