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
static_assert(kStoreTicks <= UINT8_MAX, "store_ticks_ has a byte");

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

/// Bytes of a message of the ground station that carries a CRC.
uint8_t size_of(uint16_t id) {
  if (id == kIdEmergencyStop) return message::EmergencyStop::kSize;
  if (id == kIdParamStage) return message::ParamStage::kSize;
  return message::GroundHeartbeat::kSize;
}

// No ground to level is that steep for long; beds of the steepest relief have 25 degrees.
constexpr uint16_t kWallPitch = angle_from_centidegrees(3000);

static_assert(offsetof(Parameters, site_y) == offsetof(Parameters, site_x) + sizeof(int16_t),
              "the walls of both axes follow each other");

constexpr uint8_t kImuCounts = 9;
static_assert(offsetof(SensorSample, mag) == offsetof(SensorSample, gyro) + 6 * sizeof(int16_t) &&
                  offsetof(ImuSample, mag) == 6 * sizeof(int16_t) &&
                  offsetof(Parameters, mag_offset_z) ==
                      offsetof(Parameters, gyro_offset_x) + 8 * sizeof(int16_t),
              "gyro, accelerometer and magnetometer follow each other everywhere");

}  // namespace

Robot::Robot(const BoardConstants& board, const Parameters& parameters,
             const Credentials& credentials, bool parameters_intact)
    : RobotMemory(),
      board_(board),
      parameters_(parameters),
      supervisor_(parameters_intact),
      leveling_(parameters_),
      drive_(board, parameters_),
      slip_watch_(board.tread_mm),
      telemetry_(credentials.robot_id),
      gate_(credentials),
      position_(board.count_um_q4, parameters.position_noise) {}

void Robot::begin_first_tick(const SensorSample& sample) {
  event(message::EventCode::kStarted, sample.reset_cause);
  last_left_ = sample.encoder_left;
  last_right_ = sample.encoder_right;
  started_ = true;
}

Robot::Deltas Robot::count_deltas(const SensorSample& sample) {
  // Modulo 2^16: a wrap of the counters has no effect. What no track can make is cut off.
  const Deltas deltas = {
      limit_i16(static_cast<int16_t>(static_cast<uint16_t>(sample.encoder_left - last_left_)),
                kMaxTrackCounts),
      limit_i16(static_cast<int16_t>(static_cast<uint16_t>(sample.encoder_right - last_right_)),
                kMaxTrackCounts)};
  last_left_ = sample.encoder_left;
  last_right_ = sample.encoder_right;
  return deltas;
}

SCREED_OUT_OF_LINE void Robot::estimate_pose(const SensorSample& sample, const Deltas& deltas) {
  ImuSample imu;  // all of it is written below
  auto* const to = reinterpret_cast<int16_t*>(&imu);
  const auto* const from = reinterpret_cast<const int16_t*>(
      reinterpret_cast<const uint8_t*>(&sample) + offsetof(SensorSample, gyro));
  const auto* const offset = reinterpret_cast<const int16_t*>(
      reinterpret_cast<const uint8_t*>(&parameters_) + offsetof(Parameters, gyro_offset_x));
  for (uint8_t i = 0; i < kImuCounts; ++i) {
    const auto raw = static_cast<uint16_t>(from[i]);
    const auto shift = static_cast<uint16_t>(offset[i]);
    const auto corrected = static_cast<uint16_t>(raw - shift);
    // One so near to the sensor's limit that it would change its sign stays as it is.
    const bool wrapped = (((raw ^ shift) & (raw ^ corrected)) & 0x8000U) != 0;
    to[i] = static_cast<int16_t>(wrapped ? raw : corrected);
  }
  imu.mag_fresh = (sample.fresh & kFreshMag) != 0;
  // Turning tracks are no standstill, however evenly the robot turns.
  const bool tracks_at_rest = status_.duty.duty_left == 0 && status_.duty.duty_right == 0 &&
                              deltas.left == 0 && deltas.right == 0;
  attitude_.update(imu, tracks_at_rest);
  status_.angles = attitude_.angles();
  status_.angles.heading =
      wrap_angle(status_.angles.heading - angle_from_centidegrees(parameters_.site_heading));
  position_.update(deltas.left, deltas.right, status_.angles.heading, status_.angles.pitch,
                   slip_watch_.travel_share());
  position_.keep_inside(reinterpret_cast<const int16_t(&)[2]>(parameters_.site_x));
  position_.get(status_.place);
}

void Robot::receive(const SensorSample& sample) {
  CanFrame frame{};
  const uint8_t count =
      sample.radio_in_count < kRadioInCapacity ? sample.radio_in_count : kRadioInCapacity;
  for (uint8_t i = 0; i < count; ++i) {
    if (parser_.feed(sample.radio_in[i], frame)) handle(frame);
  }
}

void Robot::handle(const CanFrame& frame) {
  const uint16_t id = telemetry_.exchange(frame.id);
  switch (id) {
    case kIdCommand:
      // Authenticated by its MAC, which a later tick checks. While one command waits, others are
      // dropped.
      if (frame.size != kCommandSize || command_pending_) break;
      memcpy(command_, frame.data, kCommandSize);
      command_pending_ = true;
      ++uplink_.frames_received;
      return;
    case kIdGroundHeartbeat:
    case kIdEmergencyStop:
    case kIdParamStage:
      if (frame.size != size_of(id) || !e2e_check(frame.id, frame.data, frame.size)) break;
      ++uplink_.frames_received;
      if (id == kIdEmergencyStop) {
        supervisor_.request(Request::kEmergencyStop);
      } else if (id == kIdParamStage) {
        memcpy(staged_, frame.data + kE2eHeaderSize, kStagedSize);
      } else {
        const auto counter = static_cast<uint8_t>((frame.data[1] & 0x0FU) + 1U);
        // A sender whose counter stands still has crashed: not a sign of life.
        if (counter != ground_counter_) {
          supervisor_.heartbeat();
          ++uplink_.ground_heartbeats;
        }
        ground_counter_ = counter;
        uplink_.ground_time_ms = get_u16(frame.data + kE2eHeaderSize);
      }
      return;
    default:
      return;  // for somebody else
  }
  ++uplink_.rejected_frames;
}

// Not in a tick with a telemetry packet: both together would exceed the longest tick.
void Robot::process_command() {
  if (!command_pending_ || telemetry_.is_packet_tick()) return;
  command_pending_ = false;
  const GateResult checked = gate_.check(telemetry_.exchange(kIdCommand), command_);
  if (checked == GateResult::kRepeated) {
    telemetry_.queue(frame_of(answer_));
    return;
  }
  const bool accepted = checked == GateResult::kAccepted;
  const RequestResult result = accepted ? execute(command_) : static_cast<RequestResult>(checked);
  const message::CommandAck answer = {command_[0], command_[kCommandFreshnessOffset],
                                      static_cast<uint8_t>(result), detail_of(result)};
  telemetry_.queue(frame_of(answer));
  if (accepted) answer_ = answer;
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
      return kParameterCount;
    default:
      return 0;
  }
}

void Robot::event(message::EventCode code, int32_t argument) {
  telemetry_.queue(frame_of(message::Event{static_cast<uint16_t>(code), argument}));
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
      drive_command_ = {drive.speed_mm_per_s, limit_i16(rate, INT16_MAX)};
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
  const uint8_t gate = located_ ? 0 : 1;
  position_.measure(kX, static_cast<int16_t>(place_cm.speed_mm_per_s * 10), parameters_.fix_sigma,
                    gate);
  position_.measure(kY, static_cast<int16_t>(place_cm.turn_ddeg_per_s * 10), parameters_.fix_sigma,
                    gate);
  located_ = true;
}

int16_t& Robot::parameter(uint8_t index) {
  return reinterpret_cast<int16_t*>(&parameters_)[index];
}

RequestResult Robot::send_parameter(uint16_t index) {
  if (index >= kParameterCount) return RequestResult::kBadArgument;
  telemetry_.queue(frame_of(message::ParamValue{index, parameter(static_cast<uint8_t>(index))}));
  return RequestResult::kDone;
}

// The staged frame is not authenticated; the commit command is. It carries the index and a CRC-16
// of index and value. For one index, a CRC-16 maps each 16-bit value to its own CRC: only the
// intended value passes.
RequestResult Robot::commit_parameter(uint8_t index, uint16_t crc) {
  if (index >= kParameterCount) return RequestResult::kBadArgument;
  const bool disarmed = supervisor_.state() == RobotState::kDisarmed;
  if (!disarmed && !changes_while_running(index)) return RequestResult::kWrongState;
  if (store_ticks_ != 0) return RequestResult::kBusy;
  const int32_t value = get_s32(staged_ + 2);
  const auto value_16 = static_cast<int16_t>(value);
  if (get_u16(staged_) != index || value_16 != value ||
      crc16_ccitt(staged_, kStagedCrcBytes) != crc) {
    return RequestResult::kBadArgument;
  }
  int16_t& parameter = this->parameter(index);
  const int16_t before = parameter;
  parameter = value_16;
  if (!parameters_.valid()) {
    parameter = before;
    return RequestResult::kBadArgument;
  }
  if (disarmed) new (&leveling_) Leveling(parameters_);
  leveling_.take(parameters_);
  drive_.take(parameters_);
  store_parameter_ = static_cast<uint8_t>(index + 1U);
  store_value_ = value_16;
  store_ticks_ = static_cast<uint8_t>(kStoreTicks);
  return RequestResult::kDone;
}

void Robot::supervise(const SensorSample& sample, const Deltas& deltas) {
  SupervisorInput input{};
  input.fresh = sample.fresh;
  input.chips_failing = sample.chips_failing;
  input.gyro = sample.gyro;
  input.accel = sample.accel;
  input.cos_tilt_q14 = status_.angles.cos_tilt_q14;
  input.estimator_ready = attitude_.ready();
  input.battery_mv = status_.battery_mv;
  input.duty_left = status_.duty.duty_left;
  input.duty_right = status_.duty.duty_right;
  input.counts_left = deltas.left;
  input.counts_right = deltas.right;
  input.stuck = slip_watch_.stuck();
  input.gave_up = supervisor_.running() && leveling_.gave_up();
  input.lost = supervisor_.running() && leveling_.lost();
  input.speed_left_dmm_per_s = drive_.speed_left_dmm_per_s();
  input.speed_right_dmm_per_s = drive_.speed_right_dmm_per_s();
  input.full_speed_mm_per_s = board_.full_speed_mm_per_s;
  input.attitude_known = attitude_.known();
  input.slips_on_purpose = strokes();
  supervisor_.tick(parameters_, input);
}

void Robot::select_motion() {
  const bool running = supervisor_.running();
  if (running && status_.state != RobotState::kRunning) {  // the state of the tick before
    leveling_.start();
    // The site lies round the place where the run began. One that goes on after a stop is the same
    // run: otherwise the site would wander with every stop.
    if (status_.state != RobotState::kStopped && !located_) {
      position_.reset();
      position_.get(status_.place);
    }
  }
  if (!running) {
    status_.motion = {0, 0};
    drive_command_ = {0, 0};
    return;
  }
  // Member by member: the Arduino IDE's C++11 knows no list for a struct with defaults.
  LevelingInput input;
  input.pitch = status_.angles.pitch;
  input.heading = status_.angles.heading;
  input.place = status_.place;
  input.drive = drive_command_;
  input.roll = status_.angles.roll;
  input.stuck = stuck_;
  input.backwards = status_.motion.speed_mm_per_s < 0;
  status_.motion = leveling_.tick(input);
}

void Robot::watch_slip(const SensorSample& sample) {
  if (strokes()) {  // slip on purpose
    slip_watch_.pass_over(drive_.left(), drive_.right());
    return;
  }
  slip_watch_.tick(drive_.left(), drive_.right(), sample.gyro, sample.accel,
                   status_.angles.sin_pitch_q14, attitude_.yaw_rate(), telemetry_.is_packet_tick());
}

// Stuck after a collision it stands at a wall, if there is one. It may climb it instead, the tracks
// gripping it, until it tips over.
void Robot::feel_walls() {
  bool stuck = slip_watch_.stuck();
  bool felt = slip_watch_.collided();
  if (abs_i16(status_.angles.pitch) > kWallPitch) {
    stuck = true;
    felt = true;
  }
  if (stuck && !stuck_) {
    Angle travel = status_.angles.heading;
    // Half a turn is the upper bit.
    if (status_.motion.speed_mm_per_s < 0) travel = static_cast<Angle>(travel ^ INT16_MIN);
    if (touch_wall(board_, parameters_, travel, felt, position_)) {
      event(message::EventCode::kWall, travel);
      leveling_.met_wall();
    }
  }
  stuck_ = stuck;
}

void Robot::announce_state() {
  const RobotState state = supervisor_.state();
  if (state == status_.state) return;
  status_.state = state;
  // faults << 8 | state, as EVENT.argument in screed.dbc
  event(message::EventCode::kState,
        static_cast<int32_t>(supervisor_.faults()) * 256 + static_cast<uint8_t>(state));
}

void Robot::report(const SensorSample& sample, RobotOutput& output) {
  TelemetryView view;
  view.sample = &sample;
  view.robot = &status_;
  view.sigma_heading = attitude_.heading_sigma();
  view.mag_disturbed = attitude_.mag_disturbed();
  view.travel_share = slip_watch_.travel_share();
  view.uplink = &uplink_;
  view.slip = slip_watch_.slips() ? 1 : 0;
  view.stuck = slip_watch_.stuck() ? 1 : 0;
  view.faults = supervisor_.reported_faults();
  view.starting = !attitude_.ready();
  view.link_alive = supervisor_.link_alive();
  view.boot_epoch = gate_.boot_epoch();
  view.freshness = gate_.counter();
  view.rejected_lines = parser_.rejected();
  view.rejected_commands = gate_.refused();
  view.algorithm = leveling_.algorithm();
  view.leveling_state = leveling_.state();
  view.peaks = leveling_.peaks();
  telemetry_.tick(view, output);
}

void Robot::write_actuators(RobotOutput& output) {
  output.store_parameter = store_parameter_;
  output.store_value = store_value_;
  store_parameter_ = 0;
  output.duty_left = status_.duty.duty_left;
  output.duty_right = status_.duty.duty_right;
  // Yellow: motors may move. Red: fault. Green: the ground station is heard.
  output.leds = static_cast<uint8_t>((supervisor_.powered() ? kLedYellow : 0) |
                                     (status_.state == RobotState::kFault ? kLedRed : 0) |
                                     (supervisor_.link_alive() ? kLedGreen : 0));
}

// The order matters. Of the tick before are: duty (rest detection, stall), slip_watch_.stuck()
// (supervisor), status_.state (start of a run). is_packet_tick() is constant until report(): ticks
// with a packet run the slip network, the others check a command's MAC.
void Robot::tick(const SensorSample& sample, RobotOutput& output) {
  // The sensor says 8184 LSB at most; a board makes less than 8 mV of each, so 16 bits hold it.
  status_.battery_mv =
      quotient_u16(mul_u16(sample.battery & 0x1FFFU, board_.battery_uv_per_lsb), 1000);
  if (!started_) begin_first_tick(sample);
  const Deltas deltas = count_deltas(sample);

  estimate_pose(sample, deltas);
  receive(sample);
  gate_.tick();
  if (store_ticks_ != 0) --store_ticks_;
  process_command();
  supervise(sample, deltas);
  select_motion();

  const DriveMeasurement measured = {deltas.left, deltas.right, attitude_.yaw_rate(),
                                     status_.battery_mv};
  if (supervisor_.powered()) {
    status_.duty = drive_.tick(status_.motion, measured, strokes());
  } else {
    drive_.idle(measured);
    status_.duty = {0, 0};
  }
  watch_slip(sample);
  feel_walls();
  announce_state();
  report(sample, output);
  write_actuators(output);
}

}  // namespace screed
