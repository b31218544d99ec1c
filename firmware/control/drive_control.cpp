// From a commanded body motion to the duty of both motors.
//
// A tick in real numbers, in the order of the code; T = 0.01 s:
//   seen        = command.yaw_rate - measured.yaw_rate, within kYawErrorLimit
//   error      += (seen - error) / 2^kYawLag       low pass of 16 T = 0.16 s, 1 Hz
//   integral   += ki T error                       ki = yaw_ki / 256; within kYawCorrectionLimit
//   correction  = kp error + integral              kp = yaw_kp / 256; within kYawCorrectionLimit
//   wanted      = speed -+ tread / 2 (command.yaw_rate + correction)     left -, right +
//   targets     = wanted, as far as accel_limit T lets them change
//   duty        = track_speed_control.h, each side
// Kinematics: thesis 5.1.2. Loop: PI behind a first-order filter, as in K. J. Astrom, T. Hagglund,
// PID Controllers, 1995. Rates are in angle units (65536 a turn) a second, the integral has 8 more
// binary digits.
#include "firmware/control/drive_control.h"

#include "firmware/math/fixed.h"

namespace screed {
namespace {

// The correction may at most add 90 degrees/s: beyond that the robot is stuck, not slipping.
constexpr int16_t kYawCorrectionLimit = 16384;
constexpr int32_t kYawIntegralLimit_q8 = static_cast<int32_t>(kYawCorrectionLimit) * 256;
// Of the yaw rate's error, 2^4 ticks: 1 Hz. Tracks on soft ground swing in yaw at 2 to 6 Hz with
// little damping; what the loop would answer there must not reach them.
constexpr uint8_t kYawLag = 4;
// Twice that and half a step still fit 16 bits; 88 degrees/s.
constexpr int16_t kYawErrorLimit = 16000;

/// Of speeds, whose difference fits 16 bits.
SCREED_OUT_OF_LINE void approach(int16_t& value, int16_t target, int16_t step) {
  value = static_cast<int16_t>(value + limit_i16(static_cast<int16_t>(target - value), step));
}

}  // namespace

DriveControl::DriveControl(const BoardConstants& board, const Parameters& parameters)
    : OwnBoard(board), parameters_(parameters), left_(board, parameters), right_(left_) {}

void DriveControl::idle(const DriveMeasurement& measured) {
  state_ = {};
  left_.release(measured.counts_left);
  right_.release(measured.counts_right);
}

SCREED_OUT_OF_LINE void DriveControl::forget_yaw() {
  state_.yaw_error = 0;
  state_.yaw_integral_q8 = 0;
}

SCREED_OUT_OF_LINE int32_t DriveControl::corrected_yaw_rate(const MotionCommand& command,
                                                            int32_t measured_rate) {
  const int16_t seen =
      limit_i16(static_cast<int32_t>(command.yaw_rate) - measured_rate, kYawErrorLimit);
  state_.yaw_error = static_cast<int16_t>(
      state_.yaw_error +
      asr_i16(static_cast<int16_t>(seen - state_.yaw_error + (1 << (kYawLag - 1))), kYawLag));
  const int16_t error = state_.yaw_error;
  // The integral is the heading lost, so it is not held while the tracks are at their limits: what
  // they owe they make up for once they can, as far as kYawCorrectionLimit lets it grow (30 degrees
  // with the default gain). ki/256 per s: ki e / 256 / 100 a tick, Q8: ki e / 100 = ki e 41 / 4096,
  // shifted in two parts to fit 32 bits.
  const int32_t step = asr(asr(mul_i16(parameters_.yaw_ki(), error), 4) * 41, 8);
  state_.yaw_integral_q8 = limit_i32(state_.yaw_integral_q8 + step, kYawIntegralLimit_q8);
  const int32_t correction =
      asr(mul_i16(parameters_.yaw_kp(), error), 8) + asr(state_.yaw_integral_q8, 8);
  // In 32 bits: the sum of two numbers of 16 does not fit the AVR's int.
  return static_cast<int32_t>(command.yaw_rate) + limit_i16(correction, kYawCorrectionLimit);
}

DriveOutput DriveControl::tick(const MotionCommand& command, const DriveMeasurement& measured,
                               bool at_once) {
  TrackSpeeds wanted = {0, 0};
  if (command.speed_mm_per_s == 0 && command.yaw_rate == 0) {
    forget_yaw();
  } else {
    wanted = SkidSteer(board().tread_mm)
                 .tracks(command.speed_mm_per_s, corrected_yaw_rate(command, measured.yaw_rate),
                         static_cast<int16_t>(board().full_speed_mm_per_s));
  }
  // Rounded up: the least limit still moves.
  const int16_t step = at_once
                           ? INT16_MAX
                           : static_cast<int16_t>(static_cast<uint16_t>(parameters_.accel_limit() +
                                                                        kTickRate_hz - 1) /
                                                  static_cast<uint16_t>(kTickRate_hz));
  approach(state_.targets.left, wanted.left, step);
  approach(state_.targets.right, wanted.right, step);
  return {left_.tick(state_.targets.left, measured.counts_left, measured.battery_mv),
          right_.tick(state_.targets.right, measured.counts_right, measured.battery_mv)};
}

}  // namespace screed
