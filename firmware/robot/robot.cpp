// The robot: the whole firmware core as one object.
#include "firmware/robot/robot.h"

#include "firmware/math/units.h"
#include "firmware/telemetry/e2e.h"

namespace screed {
namespace {

// 1 - 2 (x^2 + y^2): the element of the rotation matrix that is the cosine of the inclination.
int32_t cos_tilt_q30(const Quaternion& q) {
  return kQ30One - (mul_q30(q.x, q.x) + mul_q30(q.y, q.y)) * 2;
}

}  // namespace

Robot::Robot(const BoardConstants& board, const Parameters& parameters, bool parameters_intact)
    : battery_uv_per_lsb_(board.battery_uv_per_lsb),
      odometry_(board.count_um_q4),
      supervisor_(parameters, parameters_intact),
      leveling_(parameters),
      drive_(board, parameters) {}

Robot::Deltas Robot::count_deltas(const SensorSample& sample) {
  if (first_tick_) {
    last_left_ = sample.encoder_left;
    last_right_ = sample.encoder_right;
    first_tick_ = false;
  }
  // Modulo 2^16: a wrap of the counters has no effect.
  const Deltas deltas = {
      static_cast<int16_t>(static_cast<uint16_t>(sample.encoder_left - last_left_)),
      static_cast<int16_t>(static_cast<uint16_t>(sample.encoder_right - last_right_))};
  last_left_ = sample.encoder_left;
  last_right_ = sample.encoder_right;
  return deltas;
}

void Robot::estimate_pose(const SensorSample& sample, const Deltas& deltas) {
  ImuSample imu{};
  for (uint8_t i = 0; i < 3; ++i) {
    imu.gyro[i] = sample.gyro[i];
    imu.accel[i] = sample.accel[i];
    imu.mag[i] = sample.mag[i];
  }
  imu.mag_fresh = (sample.fresh & kFreshMag) != 0;
  // Turning tracks are no standstill, however evenly the robot turns.
  const bool tracks_at_rest =
      duty_left_ == 0 && duty_right_ == 0 && deltas.left == 0 && deltas.right == 0;
  attitude_.update(imu, tracks_at_rest);
  const AttitudeAngles angles = attitude_.angles();
  pose_.roll = angles.roll;
  pose_.pitch = angles.pitch;
  pose_.heading = angles.heading;
  odometry_.update(deltas.left, deltas.right, pose_.heading, pose_.pitch);
  pose_.x_mm = odometry_.x_mm();
  pose_.y_mm = odometry_.y_mm();
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
  if (frame.id != kIdGroundHeartbeat && frame.id != kIdCommand && frame.id != kIdEmergencyStop) {
    return;
  }
  if (!e2e_check(frame.id, frame.data, frame.size)) {
    ++rejected_frames_;
    return;
  }
  const uint8_t counter = frame.data[1] & 0x0FU;
  switch (frame.id) {
    case kIdEmergencyStop:
      supervisor_.request(Request::kEmergencyStop);
      break;
    case kIdGroundHeartbeat:
      // A sender whose counter stands still has crashed: not a sign of life.
      if (counter != ground_counter_) supervisor_.heartbeat();
      ground_counter_ = counter;
      break;
    default:
      // The counter tells a repeated line from a new command.
      if (frame.size == 6 && counter != command_counter_) {
        telemetry_.acknowledge(frame.data[2], command(frame));
      }
      command_counter_ = counter;
      break;
  }
}

RequestResult Robot::command(const CanFrame& frame) {
  switch (static_cast<CommandOp>(frame.data[2])) {
    case CommandOp::kArm:
      return supervisor_.request(Request::kArm);
    case CommandOp::kRun:
      return supervisor_.request(Request::kRun);
    case CommandOp::kStop:
      return supervisor_.request(Request::kStop);
    case CommandOp::kDisarm:
      return supervisor_.request(Request::kDisarm);
    case CommandOp::kClear:
      return supervisor_.request(Request::kClear);
    case CommandOp::kDrive: {
      const DriveArgument argument = get_drive_argument(frame.data + 3);
      // 0.1 degree/s -> angle units/s
      const int32_t rate = asr(static_cast<int32_t>(argument.turn_ddeg_per_s) * 9321, 9);
      drive_command_ = {argument.speed_mm_per_s,
                        static_cast<YawRate>(clamp_i32(rate, -INT16_MAX, INT16_MAX))};
      return RequestResult::kDone;
    }
  }
  return RequestResult::kWrongState;
}

void Robot::supervise(const SensorSample& sample, const Deltas& deltas) {
  SupervisorInput input{};
  input.fresh = sample.fresh;
  input.chips_failing = sample.chips_failing;
  input.gyro = sample.gyro;
  input.accel = sample.accel;
  input.cos_tilt_q30 = cos_tilt_q30(attitude_.orientation());
  input.estimator_ready = attitude_.ready();
  input.battery_mv = battery_mv_;
  input.duty_left = duty_left_;
  input.duty_right = duty_right_;
  input.counts_left = deltas.left;
  input.counts_right = deltas.right;
  supervisor_.tick(input);
}

void Robot::choose_motion() {
  const bool running = supervisor_.running();
  if (running && !was_running_) leveling_.start();
  was_running_ = running;
  if (!running) {
    motion_ = {0, 0};
    drive_command_ = {0, 0};
    return;
  }
  const LevelingInput input = {pose_.pitch, pose_.heading, pose_.x_mm, pose_.y_mm};
  motion_ = leveling_.tick(input, drive_command_);
}

void Robot::report(const SensorSample& sample, RobotOutput& output) {
  TelemetryView view{};
  view.sample = &sample;
  view.roll_cdeg = centidegrees_from_angle(pose_.roll);
  view.pitch_cdeg = centidegrees_from_angle(pose_.pitch);
  view.heading_cdeg = static_cast<uint16_t>(
      (static_cast<uint32_t>(static_cast<uint16_t>(pose_.heading)) * 36000U) >> 16);
  view.x_mm = pose_.x_mm;
  view.y_mm = pose_.y_mm;
  view.duty_left = duty_left_;
  view.duty_right = duty_right_;
  view.motion = motion_;
  view.state = supervisor_.state();
  view.faults = supervisor_.faults();
  view.link_alive = supervisor_.link_alive();
  view.rejected_lines = static_cast<uint8_t>(parser_.rejected() + rejected_frames_);
  view.algorithm = leveling_.algorithm();
  view.leveling_state = leveling_.state();
  view.peaks = leveling_.peaks();
  view.battery_mv = battery_mv_;
  telemetry_.tick(view, output);

  output.duty_left = duty_left_;
  output.duty_right = duty_right_;
  // Yellow: motors may move. Red: fault. Green: the ground station is heard.
  output.leds = static_cast<uint8_t>((supervisor_.powered() ? kLedYellow : 0) |
                                     (view.state == RobotState::kFault ? kLedRed : 0) |
                                     (view.link_alive ? kLedGreen : 0));
}

void Robot::tick(const SensorSample& sample, RobotOutput& output) {
  // At most 65,535 mV: what the sensor can say (8184 LSB) is far below.
  const uint32_t battery_uv = static_cast<uint32_t>(sample.battery) * battery_uv_per_lsb_;
  battery_mv_ = battery_uv < static_cast<uint32_t>(1000) << 16 ? quotient_u16(battery_uv, 1000)
                                                               : static_cast<uint16_t>(0xFFFFU);
  const Deltas deltas = count_deltas(sample);

  estimate_pose(sample, deltas);
  receive(sample);
  supervise(sample, deltas);
  choose_motion();

  const DriveMeasurement measured = {deltas.left, deltas.right, attitude_.yaw_rate(), battery_mv_};
  if (supervisor_.powered()) {
    const DriveOutput duty = drive_.tick(motion_, measured);
    duty_left_ = duty.duty_left;
    duty_right_ = duty.duty_right;
  } else {
    drive_.idle(measured);
    duty_left_ = 0;
    duty_right_ = 0;
  }
  report(sample, output);
}

}  // namespace screed
