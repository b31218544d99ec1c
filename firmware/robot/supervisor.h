// The robot's safe state machine: who may drive, and what stops it.
//
//   disarmed --arm--> armed --run--> running --stop, or link lost 0.5 s--> stopped --run--> running
//   armed, running, stopped --disarm, or link lost 1.5 s--> disarmed
//   armed, running, stopped --fault--> fault;  any state --emergency stop--> fault
//   fault --clear, once no cause is present--> disarmed
//
// A stand-alone robot ignores the link. While disarmed, a present fault only prevents arming.
//
// Motors get power in `running`, and in `stopped` while they ramp down; never elsewhere. A fault is
// latched with its cause.
#pragma once

#include <stdint.h>

#include "firmware/math/fixed.h"
#include "firmware/parameters/parameters.h"
#include "firmware/protocol/messages.h"
#include "hal/sample.h"

namespace screed {

/// Names and numbers come from the schema: screed.dbc.
using RobotState = message::HeartbeatState;

/// Causes of kFault, one bit each, as latched and as sent in the heartbeat. A new one is a line of
/// screed.dbc and its logic in Supervisor::look_for_faults().
using Fault = message::HeartbeatFaults;

/// Requests, from the ground station.
enum class Request : uint8_t {
  kNone = 0,
  kArm = 1,
  kRun = 2,
  kStop = 3,
  kDisarm = 4,
  kClear = 5,
  kEmergencyStop = 6
};

/// Answer to a request; its names come from the schema.
using RequestResult = message::CommandAckResult;

struct SupervisorInput {
  uint8_t fresh;         ///< SensorSample::fresh
  const int16_t* gyro;   ///< three raw counts
  const int16_t* accel;  ///< three raw counts
  int16_t cos_tilt_q14;  ///< cosine of the estimated inclination
  bool estimator_ready;
  uint16_t battery_mv;
  int16_t duty_left;  ///< of the last tick
  int16_t duty_right;
  int16_t counts_left;  ///< encoder counts since the last tick
  int16_t counts_right;
  uint8_t chips_failing = 0;         ///< SensorSample::chips_failing
  bool stuck = false;                ///< the tracks turn and the robot does not move (slip_watch.h)
  bool gave_up = false;              ///< stuck, and the escape did not help
  bool lost = false;                 ///< it does not know where it is, and is to stop then
  int16_t speed_left_dmm_per_s = 0;  ///< observed in the last tick, 0.1 mm/s
  int16_t speed_right_dmm_per_s = 0;
  uint16_t full_speed_mm_per_s = 0;  ///< of the board, below 8192
  bool attitude_known = false;       ///< cos_tilt_q14 may be relied on
  bool slips_on_purpose = false;     ///< it strokes (strokes.h)
};

/// Watches one driven track: whether it makes progress, and whether it does what its motor is told.
///
/// It keeps the farthest position reached in the direction of the duty. A track that gets farther,
/// or falls back by two counts, moves. A stalled track makes no counts; with a broken encoder wire
/// it alternates by one count, since one channel gives no direction. Both stay within one count of
/// the farthest position.
class TrackWatch {
 public:
  void tick(int16_t duty, int16_t counts);
  /// One tick: a track that moves fast without duty in its direction is driven by something else,
  /// or its encoder counts the wrong way. full_speed_mm_per_s: of the board, below 8192.
  void compare(int16_t duty, int16_t speed_dmm_per_s, uint16_t full_speed_mm_per_s);
  bool disobeys() const;
  /// Ticks at high duty without progress.
  uint16_t still_ticks() const { return still_ticks_; }
  bool alternates() const;
  /// tick() and compare(), and what they find, as the left track's faults (bits of Fault).
  uint16_t faults(int16_t duty, int16_t counts, int16_t speed_dmm_per_s,
                  uint16_t full_speed_mm_per_s, uint16_t stall_ticks);

 private:
  uint16_t still_ticks_ = 0;
  int8_t counts_behind_farthest_ = 0;  ///< 0 or 1
  uint8_t reversals_ = 0;              ///< alternations since the last progress
  uint8_t disobedience_ = 0;           ///< ticks, those against high duty twice
};

class Supervisor {
 public:
  /// Parameters that are not intact are a fault for good; intact ones that are not valid are one
  /// until a change makes them valid.
  explicit Supervisor(bool parameters_intact = true);

  /// One tick: looks for faults, watches the link, runs the stand-alone timer. The parameters are
  /// those of this tick.
  void tick(const Parameters& parameters, const SupervisorInput& input);

  RequestResult request(Request request);
  /// A valid heartbeat of the ground station arrived.
  void heartbeat() { state_.ticks_since_heartbeat = 0; }

  RobotState state() const { return state_.state; }
  bool running() const { return state_.state == RobotState::kRunning; }
  /// The motors may have power: running, or ramping down.
  bool powered() const {
    return state_.state == RobotState::kRunning || state_.state == RobotState::kStopped;
  }
  /// Latched causes; non-zero exactly in kFault.
  uint16_t faults() const { return state_.latched; }
  /// Causes that are there now, latched or not.
  uint16_t present_faults() const { return state_.present; }
  /// What the heartbeat says: the latched causes in kFault, else those present, which would prevent
  /// arming. Present causes latch at once in the states between, so there are none.
  uint16_t reported_faults() const {
    return state_.state == RobotState::kFault ? state_.latched : state_.present;
  }
  /// The ground station was heard within the last 0.5 s.
  bool link_alive() const;

 private:
  /// What the supervisor remembers, zero at the start but the time without a heartbeat: zeroed at
  /// once, which takes less flash.
  struct State {
    RobotState state;
    uint16_t latched;
    uint16_t present;  ///< causes seen in the last tick
    bool estimator_ready;
    bool standalone;
    uint16_t ticks_since_heartbeat;
    uint16_t ticks_since_start;
    uint8_t tilt_ticks;
    uint8_t silent_gyro_ticks;
    uint8_t silent_accel_ticks;
    uint8_t frozen_gyro_ticks;
    uint8_t battery_ticks;
    uint8_t chip_ticks;
    uint16_t stuck_for;  ///< ticks
    TrackWatch left;
    TrackWatch right;
    int16_t last_gyro[3];
  };

  uint16_t look_for_faults(const Parameters& parameters, const SupervisorInput& input);
  bool tilted(const Parameters& parameters, const SupervisorInput& input);
  void watch_link();
  void run_standalone(uint16_t delay_ticks);

  State state_{};
  bool parameters_intact_;
};

}  // namespace screed
