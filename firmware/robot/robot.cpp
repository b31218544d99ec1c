// The robot: the whole firmware core as one object.
#include "firmware/robot/robot.h"

#include <stddef.h>
#include <string.h>

#include "firmware/math/crc16.h"
#include "firmware/math/units.h"
#include "firmware/parameters/parameter_store.h"
#include "firmware/protocol/e2e.h"

namespace screed {

namespace {

// The EEPROM takes a byte a tick, and two copies at first.
constexpr uint16_t kStoreTicks = kParameterCopies * kParameterCopySize + 8;
static_assert(kStoreTicks <= UINT8_MAX, "state_.store_ticks has a byte");

static_assert(
    static_cast<uint8_t>(GateResult::kNoKey) == static_cast<uint8_t>(RequestResult::kNoKey) &&
        static_cast<uint8_t>(GateResult::kBadMac) == static_cast<uint8_t>(RequestResult::kBadMac) &&
        static_cast<uint8_t>(GateResult::kLockedOut) ==
            static_cast<uint8_t>(RequestResult::kLockedOut) &&
        static_cast<uint8_t>(GateResult::kUsedUp) == static_cast<uint8_t>(RequestResult::kUsedUp),
    "refusals travel under the numbers of the schema");
static_assert(static_cast<uint8_t>(Request::kArm) == static_cast<uint8_t>(CommandOp::kArm) &&
                  static_cast<uint8_t>(Request::kRun) == static_cast<uint8_t>(CommandOp::kRun) &&
                  static_cast<uint8_t>(Request::kStop) == static_cast<uint8_t>(CommandOp::kStop) &&
                  static_cast<uint8_t>(Request::kDisarm) ==
                      static_cast<uint8_t>(CommandOp::kDisarm) &&
                  static_cast<uint8_t>(Request::kClear) == static_cast<uint8_t>(CommandOp::kClear),
              "these commands are requests of the same number");

/// Bytes of a message of the ground station; 0: of somebody else.
uint8_t size_of(uint16_t id) {
  switch (id) {
    case kIdCommand:
      return kCommandSize;
    case kIdGroundHeartbeat:
      return message::GroundHeartbeat::kSize;
    case kIdEmergencyStop:
      return message::EmergencyStop::kSize;
    case kIdParamStage:
      return message::ParamStage::kSize;
    default:
      return 0;
  }
}

/// Modulo 2^16: a wrap of the counters has no effect. What no track can make is cut off.
SCREED_OUT_OF_LINE int16_t counts_since(uint16_t& last, uint16_t now) {
  const auto counts = static_cast<int16_t>(static_cast<uint16_t>(now - last));
  last = now;
  return clamp_i16(counts, -kMaxTrackCounts, kMaxTrackCounts);
}

// No ground to level is that steep for long; beds of the steepest relief have 25 degrees.
constexpr uint16_t kWallPitch = angle_from_centidegrees(3000);

static_assert(Parameters::k_site_y == Parameters::k_site_x + 1,
              "the walls of both axes follow each other");
static_assert(Parameters::k_mag_offset_z == Parameters::k_gyro_offset_x + ImuCounts::kSize - 1,
              "the offsets are in the order of ImuCounts");

}  // namespace

Robot::Robot(const BoardConstants& board, const Parameters& parameters,
             const Credentials& credentials, bool parameters_intact)
    : OwnBoard(board),
      parameters_(parameters),
      supervisor_(parameters_intact),
      leveling_(parameters_),
      drive_(board, parameters_),
      slip_watch_(board.tread_mm),
      telemetry_(credentials.robot_id),
      gate_(credentials),
      position_(board.count_um_q4, parameters.position_noise()) {}

Robot::Deltas Robot::count_deltas(const SensorSample& sample) {
  return {counts_since(state_.last_left, sample.encoder_left),
          counts_since(state_.last_right, sample.encoder_right)};
}

SCREED_OUT_OF_LINE void Robot::estimate_pose(const SensorSample& sample, const Deltas& deltas) {
  ImuSample imu;  // all of it is written below
  const int16_t* const offset = &parameters_.values[Parameters::k_gyro_offset_x];
  for (uint8_t i = 0; i < ImuCounts::kSize; ++i) {
    const auto raw = static_cast<uint16_t>(sample.imu.all[i]);
    const auto shift = static_cast<uint16_t>(offset[i]);
    const auto corrected = static_cast<uint16_t>(raw - shift);
    // One so near to the sensor's limit that it would change its sign stays as it is.
    const bool wrapped = (((raw ^ shift) & (raw ^ corrected)) & 0x8000U) != 0;
    imu.imu.all[i] = static_cast<int16_t>(wrapped ? raw : corrected);
  }
  imu.mag_fresh = (sample.fresh & kFreshMag) != 0;
  // Turning tracks are no standstill, however evenly the robot turns.
  const bool tracks_at_rest = state_.status.duty.duty_left == 0 &&
                              state_.status.duty.duty_right == 0 && deltas.left == 0 &&
                              deltas.right == 0;
  attitude_.update(imu, tracks_at_rest);
  state_.status.angles = attitude_.angles();
  state_.status.angles.heading = wrap_angle(state_.status.angles.heading -
                                            angle_from_centidegrees(parameters_.site_heading()));
  position_.update(deltas.left, deltas.right, state_.status.angles.heading,
                   state_.status.angles.pitch, slip_watch_.travel_share());
  position_.keep_inside(&parameters_.values[Parameters::k_site_x]);
  position_.get(state_.status.place);
}

void Robot::receive(const SensorSample& sample) {
  CanFrame frame;  // what is read of it the parser has written
  const uint8_t count =
      sample.radio_in_count < kRadioInCapacity ? sample.radio_in_count : kRadioInCapacity;
  for (uint8_t i = 0; i < count; ++i) {
    if (parser_.feed(sample.radio_in[i], frame)) handle(frame);
  }
}

void Robot::handle(const CanFrame& frame) {
  const uint16_t id = telemetry_.exchange(frame.id);
  const uint8_t size = size_of(id);
  if (size == 0) return;
  // A command is authenticated by its MAC, which a later tick checks. While one waits, others are
  // dropped.
  const bool command = id == kIdCommand;
  if (frame.size != size ||
      (command ? state_.command_pending : !e2e_check(frame.id, frame.data, frame.size))) {
    ++state_.uplink.rejected_frames;
    return;
  }
  ++state_.uplink.frames_received;
  if (command) {
    memcpy(state_.command, frame.data, kCommandSize);
    state_.command_pending = true;
  } else if (id == kIdEmergencyStop) {
    supervisor_.request(Request::kEmergencyStop);
  } else if (id == kIdParamStage) {
    memcpy(state_.staged, frame.data + kE2eHeaderSize, kStagedSize);
  } else {
    const auto counter = static_cast<uint8_t>((frame.data[1] & 0x0FU) + 1U);
    // A sender whose counter stands still has crashed: not a sign of life.
    if (counter != state_.ground_counter) {
      supervisor_.heartbeat();
      ++state_.uplink.ground_heartbeats;
    }
    state_.ground_counter = counter;
    state_.uplink.ground_time_ms = get_u16(frame.data + kE2eHeaderSize);
  }
}

// Not in a tick with a telemetry packet: both together would exceed the longest tick.
void Robot::process_command() {
  if (!state_.command_pending || telemetry_.is_packet_tick()) return;
  state_.command_pending = false;
  const GateResult checked = gate_.check(telemetry_.exchange(kIdCommand), state_.command);
  if (checked == GateResult::kRepeated) {
    telemetry_.queue(state_.answer);
    return;
  }
  const bool accepted = checked == GateResult::kAccepted;
  const RequestResult result =
      accepted ? execute(state_.command) : static_cast<RequestResult>(checked);
  CanFrame answer;  // what is sent of it is written below
  answer.id = kIdCommandAck;
  set(answer, message::CommandAck{state_.command[0], state_.command[kCommandFreshnessOffset],
                                  static_cast<uint8_t>(result), detail_of(result)});
  telemetry_.queue(answer);
  if (accepted) state_.answer = answer;
  if (checked == GateResult::kBadMac && gate_.locked_ticks() != 0) {
    event(message::EventCode::kLockedOut, gate_.locked_ticks());
  }
}

uint16_t Robot::detail_of(RequestResult result) const {
  switch (result) {
    case RequestResult::kFaultPresent:
      return supervisor_.present_faults();
    case RequestResult::kLockedOut:
      return gate_.locked_ticks();
    case RequestResult::kBadMac:
    case RequestResult::kUsedUp:
      return gate_.counter();
    case RequestResult::kBadArgument:
      return Parameters::kCount;
    default:
      return 0;
  }
}

// EVENT and PARAM_VALUE are two numbers of the same sizes: their code is in the image once.
SCREED_OUT_OF_LINE void Robot::queue_numbers(uint16_t id, uint16_t what, int32_t value) {
  static_assert(uint8_t{message::ParamValue::kSize} == uint8_t{message::Event::kSize}, "alike");
  CanFrame frame;  // what is sent of it is written below
  frame.id = id;
  set(frame, message::Event{what, value});
  telemetry_.queue(frame);
}

void Robot::event(message::EventCode code, int32_t argument) {
  queue_numbers(kIdEvent, static_cast<uint16_t>(code), argument);
}

RequestResult Robot::execute(const uint8_t* data) {
  const uint8_t* const argument = data + 1;
  switch (static_cast<CommandOp>(data[0])) {
    case CommandOp::kArm:
    case CommandOp::kRun:
    case CommandOp::kStop:
    case CommandOp::kDisarm:
    case CommandOp::kClear:
      return supervisor_.request(static_cast<Request>(data[0]));
    case CommandOp::kDrive: {
      if (!supervisor_.running() || leveling_.algorithm() != LevelingAlgorithm::kDrive) {
        return RequestResult::kWrongState;
      }
      const DriveArgument drive = get_drive_argument(argument);
      // 0.1 degree/s -> angle units/s: 9321 / 2^9 = 65536 / 3600
      const int32_t rate = asr(static_cast<int32_t>(drive.turn_ddeg_per_s) * 9321, 9);
      state_.drive_command = {drive.speed_mm_per_s, limit_i16(rate, INT16_MAX)};
      return RequestResult::kDone;
    }
    case CommandOp::kPositionFix:
      fix_position(get_drive_argument(argument));
      return RequestResult::kDone;
    case CommandOp::kParameterRead:
      return send_parameter(get_u16(argument));
    case CommandOp::kParameterCommit:
      return commit_parameter(argument[0], get_u16(argument + 1));
  }
  return RequestResult::kBadArgument;
}

void Robot::fix_position(const DriveArgument& place_cm) {
  // Who sends them has left out what is false. The first one tells where the robot was put: where
  // that is not where it believes to be, it doubts both, and takes the second.
  const uint8_t gate = state_.located ? 0 : 1;
  position_.measure(kX, static_cast<int16_t>(place_cm.speed_mm_per_s * 10), parameters_.fix_sigma(),
                    gate);
  position_.measure(kY, static_cast<int16_t>(place_cm.turn_ddeg_per_s * 10),
                    parameters_.fix_sigma(), gate);
  state_.located = true;
}

RequestResult Robot::send_parameter(uint16_t index) {
  if (index >= Parameters::kCount) return RequestResult::kBadArgument;
  queue_numbers(kIdParamValue, index, parameters_.values[index]);
  return RequestResult::kDone;
}

// The staged frame is not authenticated; the commit command is. It carries the index and a CRC-16
// of index and value. For one index, a CRC-16 maps each 16-bit value to its own CRC: only the
// intended value passes.
RequestResult Robot::commit_parameter(uint8_t index, uint16_t crc) {
  if (index >= Parameters::kCount) return RequestResult::kBadArgument;
  const bool disarmed = supervisor_.state() == RobotState::kDisarmed;
  if (!disarmed && !changes_while_running(index)) return RequestResult::kWrongState;
  if (state_.store_ticks != 0) return RequestResult::kBusy;
  const int32_t value = get_s32(state_.staged + 2);
  const auto value_16 = static_cast<int16_t>(value);
  if (get_u16(state_.staged) != index || value_16 != value ||
      crc16_ccitt(state_.staged, kStagedCrcBytes) != crc) {
    return RequestResult::kBadArgument;
  }
  int16_t& parameter = parameters_.values[index];
  const int16_t before = parameter;
  parameter = value_16;
  if (!parameters_.valid()) {
    parameter = before;
    return RequestResult::kBadArgument;
  }
  if (disarmed) new (&leveling_) Leveling(parameters_);
  leveling_.take(parameters_);
  drive_.take(parameters_);
  state_.store_parameter = static_cast<uint8_t>(index + 1U);
  state_.store_value = value_16;
  state_.store_ticks = static_cast<uint8_t>(kStoreTicks);
  return RequestResult::kDone;
}

void Robot::supervise(const SensorSample& sample, const Deltas& deltas) {
  SupervisorInput input{};
  input.fresh = sample.fresh;
  input.chips_failing = sample.chips_failing;
  input.gyro = sample.imu.gyro();
  input.accel = sample.imu.accel();
  input.cos_tilt_q14 = state_.status.angles.cos_tilt_q14;
  input.estimator_ready = attitude_.ready();
  input.battery_mv = state_.status.battery_mv;
  input.duty_left = state_.status.duty.duty_left;
  input.duty_right = state_.status.duty.duty_right;
  input.counts_left = deltas.left;
  input.counts_right = deltas.right;
  input.stuck = slip_watch_.stuck();
  input.gave_up = supervisor_.running() && leveling_.gave_up();
  input.lost = supervisor_.running() && leveling_.lost();
  input.speed_left_dmm_per_s = drive_.speed_left_dmm_per_s();
  input.speed_right_dmm_per_s = drive_.speed_right_dmm_per_s();
  input.full_speed_mm_per_s = board().full_speed_mm_per_s;
  input.attitude_known = attitude_.known();
  input.slips_on_purpose = strokes();
  supervisor_.tick(parameters_, input);
}

void Robot::select_motion() {
  const bool running = supervisor_.running();
  if (running && state_.status.state != RobotState::kRunning) {  // the state of the tick before
    leveling_.start();
    // The site lies round the place where the run began. One that goes on after a stop is the same
    // run: otherwise the site would wander with every stop.
    if (state_.status.state != RobotState::kStopped && !state_.located) {
      position_.reset();
      position_.get(state_.status.place);
    }
  }
  if (!running) {
    state_.status.motion = {0, 0};
    state_.drive_command = {0, 0};
    return;
  }
  // Member by member: the Arduino IDE's C++11 knows no list for a struct with defaults.
  LevelingInput input;
  input.pitch = state_.status.angles.pitch;
  input.heading = state_.status.angles.heading;
  input.place = state_.status.place;
  input.drive = state_.drive_command;
  input.roll = state_.status.angles.roll;
  input.stuck = state_.stuck;
  input.backwards = state_.status.motion.speed_mm_per_s < 0;
  state_.status.motion = leveling_.tick(input);
}

void Robot::watch_slip(const SensorSample& sample) {
  if (strokes()) {  // slip on purpose
    slip_watch_.pass_over(drive_.left(), drive_.right());
    return;
  }
  slip_watch_.tick(drive_.left(), drive_.right(), sample.imu.gyro(), sample.imu.accel(),
                   state_.status.angles.sin_pitch_q14, attitude_.yaw_rate(),
                   telemetry_.is_packet_tick());
}

// Stuck after a collision it stands at a wall, if there is one. It may climb it instead, the tracks
// gripping it, until it tips over. What stops its escape is the hole it stands in.
void Robot::feel_walls() {
  bool stuck = slip_watch_.stuck();
  bool felt = slip_watch_.collided();
  if (abs_i16(state_.status.angles.pitch) > kWallPitch) {
    stuck = true;
    felt = true;
  }
  if (stuck && !state_.stuck && leveling_.state() != LevelingState::kEscape) {
    Angle travel = state_.status.angles.heading;
    // Half a turn is the upper bit.
    if (state_.status.motion.speed_mm_per_s < 0) travel = static_cast<Angle>(travel ^ INT16_MIN);
    if (touch_wall(board(), parameters_, travel, felt, position_)) {
      event(message::EventCode::kWall, travel);
      leveling_.met_wall();
    }
  }
  state_.stuck = stuck;
}

void Robot::announce_state() {
  const RobotState state = supervisor_.state();
  if (state == state_.status.state) return;
  state_.status.state = state;
  // faults << 8 | state, as EVENT.argument in screed.dbc
  event(message::EventCode::kState,
        static_cast<int32_t>(supervisor_.faults()) * 256 + static_cast<uint8_t>(state));
}

void Robot::write_actuators(RobotOutput& output) {
  output.store_parameter = state_.store_parameter;
  output.store_value = state_.store_value;
  state_.store_parameter = 0;
  output.duty_left = state_.status.duty.duty_left;
  output.duty_right = state_.status.duty.duty_right;
  // Yellow: motors may move. Red: fault. Green: the ground station is heard.
  output.leds = static_cast<uint8_t>((supervisor_.powered() ? kLedYellow : 0) |
                                     (state_.status.state == RobotState::kFault ? kLedRed : 0) |
                                     (supervisor_.link_alive() ? kLedGreen : 0));
}

// The order matters. Of the tick before are: duty (rest detection, stall), slip_watch_.stuck()
// (supervisor), state_.status.state (start of a run). is_packet_tick() is constant until report():
// ticks with a packet run the slip network, the others check a command's MAC.
void Robot::tick(const SensorSample& sample, RobotOutput& output) {
  // The sensor says 8184 LSB at most; a board makes less than 8 mV of each, so 16 bits hold it.
  state_.status.battery_mv =
      quotient_u16(mul_u16(sample.battery & 0x1FFFU, board().battery_uv_per_lsb), 1000);
  Deltas deltas = count_deltas(sample);
  if (!state_.started) {
    event(message::EventCode::kStarted, sample.reset_cause);
    deltas = {0, 0};
    state_.started = true;
  }

  estimate_pose(sample, deltas);
  receive(sample);
  gate_.tick();
  if (state_.store_ticks != 0) --state_.store_ticks;
  process_command();
  supervise(sample, deltas);
  select_motion();

  const DriveMeasurement measured = {deltas.left, deltas.right, attitude_.yaw_rate(),
                                     state_.status.battery_mv};
  if (supervisor_.powered()) {
    state_.status.duty = drive_.tick(state_.status.motion, measured, strokes());
  } else {
    drive_.idle(measured);
    state_.status.duty = {0, 0};
  }
  watch_slip(sample);
  feel_walls();
  announce_state();
  report(sample, output);
  write_actuators(output);
}

}  // namespace screed
