// The robot: what it keeps from tick to tick, and what it does in one.
#pragma once

#include <stdint.h>

#include "firmware/control/drive_control.h"
#include "firmware/estimation/attitude.h"
#include "firmware/estimation/place.h"
#include "firmware/estimation/position_estimate.h"
#include "firmware/estimation/slip_watch.h"
#include "firmware/leveling/leveling.h"
#include "firmware/parameters/own_board.h"
#include "firmware/parameters/parameters.h"
#include "firmware/robot/supervisor.h"
#include "firmware/robot/telemetry.h"
#include "firmware/security/command_gate.h"
#include "hal/sample.h"

namespace screed {

// State that the robot keeps from tick to tick and that supervisor, leveling and drive share.
// Telemetry only reads it.

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

// The robot: the whole firmware core as one object. Samples in, outputs out, nothing else.
//
// A Robot holds all state of the control program. It makes no HAL call, keeps no static, allocates
// nothing and does no floating point, so a recorded run replays to the bit, a test needs no fake,
// and many robots fit in one process.

class Robot : private OwnBoard {
 public:
  /// `parameters_intact` = false: the parameters stand in for lost ones; the robot refuses to be
  /// armed.
  Robot(const BoardConstants& board, const Parameters& parameters, const Credentials& credentials,
        bool parameters_intact = true);

  /// One control tick. The sample's encoder counts may start anywhere; the first tick takes them as
  /// zero.
  void tick(const SensorSample& sample, RobotOutput& output);

  // What the robot thinks, for recording and tests.
  const AttitudeEstimator& attitude() const { return attitude_; }
  const PositionEstimate& position() const { return position_; }
  const Supervisor& supervisor() const { return supervisor_; }
  const Leveling& leveling() const { return leveling_; }
  const DriveControl& drive() const { return drive_; }
  const MotionCommand& motion() const { return state_.status.motion; }
  const Parameters& parameters() const { return parameters_; }
  const CommandGate& gate() const { return gate_; }
  const SlipWatch& slip_watch() const { return slip_watch_; }

 private:
  static constexpr uint8_t kStagedSize = 6;  ///< u16, s32
  /// What a robot remembers beside its parts, zero at the start. By itself so that it is zeroed at
  /// once: member by member that takes 150 bytes of flash more.
  struct State {
    RobotStatus status;
    MotionCommand drive_command;  ///< last CommandOp::kDrive
    uint16_t last_left;
    uint16_t last_right;
    uint8_t staged[kStagedSize];  ///< index and value of a PARAM_STAGE
    uint8_t store_parameter;      ///< as RobotOutput
    int16_t store_value;
    uint8_t store_ticks;     ///< until the EEPROM takes another parameter
    uint8_t ground_counter;  ///< alive counter of the last ground heartbeat, plus 1; 0: none yet
    UplinkCounts uplink;
    bool command_pending;
    // One byte: with the core's USB there is no other left below its word in RAM.
    bool started : 1;  ///< the first tick is over
    bool located : 1;  ///< a position fix has told where the robot is
    bool stuck;
    uint8_t command[kCommandSize];  ///< waits for its tick
    // What the downlink says of intervals.
    uint8_t heartbeats_before;  ///< UplinkCounts::ground_heartbeats at the last LINK
    uint16_t longest_tick_us;   ///< since the last HEALTH
    uint32_t time_ms;           ///< at the last TIME; the sample's time wraps after 71.6 minutes
    uint32_t time_us;           ///< the sample's, then
    /// To the last command that was accepted. Last, since members behind it would be out of reach.
    CanFrame answer;
  };

  struct Deltas {
    int16_t left;
    int16_t right;
  };

  static constexpr uint8_t kStagedCrcBytes = 4;  ///< index and lower half of the value

  Deltas count_deltas(const SensorSample& sample);
  void estimate_pose(const SensorSample& sample, const Deltas& deltas);
  void receive(const SensorSample& sample);
  void handle(const CanFrame& frame);
  void process_command();
  RequestResult execute(const uint8_t* data);
  void fix_position(const DriveArgument& place_cm);
  RequestResult send_parameter(uint16_t index);
  RequestResult commit_parameter(uint8_t index, uint16_t crc);
  uint16_t detail_of(RequestResult result) const;
  void queue_numbers(uint16_t id, uint16_t what, int32_t value);
  void event(message::EventCode code, int32_t argument);
  void supervise(const SensorSample& sample, const Deltas& deltas);
  void select_motion();
  void watch_slip(const SensorSample& sample);
  void feel_walls();
  /// It strokes: its tracks change their speed at once and slip.
  bool strokes() const {
    return algorithm_in_build(static_cast<int16_t>(LevelingAlgorithm::kStrokes)) &&
           supervisor_.running() && leveling_.state() == LevelingState::kStroke;
  }
  void announce_state();
  void report(const SensorSample& sample, RobotOutput& output);
  /// The frame of this id. Once for each that is sent: HEALTH and LINK start new intervals here.
  void fill(CanFrame& frame, const SensorSample& sample);
  void write_actuators(RobotOutput& output);

  State state_{};
  Parameters parameters_;
  AttitudeEstimator attitude_;
  Supervisor supervisor_;
  Leveling leveling_;
  DriveControl drive_;
  SlipWatch slip_watch_;
  SlcanParser parser_;
  Telemetry telemetry_;
  CommandGate gate_;
  PositionEstimate position_;
};

}  // namespace screed
