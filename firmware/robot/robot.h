// The robot: the whole firmware core as one object. Samples in, outputs out, nothing else.
//
// A Robot holds all state of the control program. It makes no HAL call, keeps no static, allocates
// nothing and does no floating point, so a recorded run replays to the bit, a test needs no fake,
// and many robots fit in one process.
#pragma once

#include "firmware/control/drive_control.h"
#include "firmware/estimation/attitude.h"
#include "firmware/estimation/position_estimate.h"
#include "firmware/estimation/site_walls.h"
#include "firmware/estimation/slip_watch.h"
#include "firmware/leveling/leveling.h"
#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/kept.h"
#include "firmware/parameters/parameters.h"
#include "firmware/robot/robot_status.h"
#include "firmware/robot/supervisor.h"
#include "firmware/robot/telemetry.h"
#include "firmware/security/command_gate.h"
#include "hal/sample.h"

namespace screed {

/// What a robot remembers beside its parts, zero at the start. By itself so that it is zeroed at
/// once: member by member that takes 150 bytes of flash more.
struct RobotMemory {
  static constexpr uint8_t kStagedSize = 6;  ///< u16, s32

  RobotStatus status_;
  MotionCommand drive_command_;  ///< last CommandOp::kDrive
  uint16_t last_left_;
  uint16_t last_right_;
  message::CommandAck answer_;   ///< to the last command that was accepted
  uint8_t staged_[kStagedSize];  ///< index and value of a PARAM_STAGE
  uint8_t store_parameter_;      ///< as RobotOutput
  int16_t store_value_;
  uint8_t store_ticks_;     ///< until the EEPROM takes another parameter
  uint8_t ground_counter_;  ///< alive counter of the last ground heartbeat, plus 1; 0: none yet
  UplinkCounts uplink_;
  bool command_pending_;
  // One byte: with the core's USB there is no other left below its word in RAM.
  bool started_ : 1;  ///< the first tick is over
  bool located_ : 1;  ///< a position fix has told where the robot is
  bool stuck_;
  uint8_t command_[kCommandSize];  ///< waits for its tick
};

class Robot : private RobotMemory {
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
  const MotionCommand& motion() const { return status_.motion; }
  const Parameters& parameters() const { return parameters_; }
  const CommandGate& gate() const { return gate_; }
  const SlipWatch& slip_watch() const { return slip_watch_; }

 private:
  struct Deltas {
    int16_t left;
    int16_t right;
  };

  static constexpr uint8_t kStagedCrcBytes = 4;  ///< index and lower half of the value

  void begin_first_tick(const SensorSample& sample);
  Deltas count_deltas(const SensorSample& sample);
  void estimate_pose(const SensorSample& sample, const Deltas& deltas);
  void receive(const SensorSample& sample);
  void handle(const CanFrame& frame);
  void process_command();
  RequestResult execute(const uint8_t* data);
  void fix_position(const DriveArgument& place_cm);
  int16_t& parameter(uint8_t index);
  RequestResult send_parameter(uint16_t index);
  RequestResult commit_parameter(uint8_t index, uint16_t crc);
  uint16_t detail_of(RequestResult result) const;
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
  void write_actuators(RobotOutput& output);

  Kept<BoardConstants> board_;
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
