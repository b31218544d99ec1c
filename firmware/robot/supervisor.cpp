// The robot's safe state machine.
#include "firmware/robot/supervisor.h"

#include "firmware/math/sqrt.h"
#include "firmware/math/units.h"

namespace screed {
namespace {

// Deadlines from cause to reaction, in ticks of 10 ms.
constexpr uint8_t kTiltTicks = 6;     // 60 ms; the reaction must come within 100 ms
constexpr uint8_t kSilentTicks = 8;   // 80 ms; the reaction must come within 100 ms
constexpr uint8_t kFrozenTicks = 18;  // 180 ms; the reaction must come within 200 ms
constexpr uint8_t kChipTicks = 5;     // a hitch of the bus is no fault
// Chips that driving relies on; a failing barometer is only reported (HEALTH).
constexpr uint8_t kVitalChips = ChipBit::kAccelMagChip | ChipBit::kGyroChip;
constexpr uint8_t kBatteryTicks = 100;  // a start-up dip is not an empty battery
constexpr uint16_t kLinkStopTicks = 50;
constexpr uint16_t kLinkDisarmTicks = 150;
// The accelerometer is taken for a plumb line while nothing turns faster than 57 degrees/s and it
// feels 0.8 to 1.2 g.
constexpr uint16_t kMaxRestGyro = 814;
constexpr uint16_t kMinRestAccel = 819;
constexpr uint16_t kMaxRestAccel = 1229;
// A track that does not move below this duty is not stalled, it is asked for too little: 69 mm/s
// without load. A blocked track that is to drive slower gets it within 50 ms.
constexpr int16_t kStallDuty = 110;
// From this duty on a track is meant to move.
constexpr int16_t kPushDuty = 60;
// A track that moves faster than two fifths of its full speed (in mm/s: 4 of it in 0.1 mm/s)
// without being pushed has another driver. On a slope of 25 degrees gravity alone makes no half of
// it.
constexpr uint8_t kDrivenSpeed = 4;
// Against this duty no track moves on for long, faster than a fifth.
constexpr int16_t kReverseDuty = 240;
constexpr uint8_t kReversedSpeed = 2;
constexpr uint8_t kDisobedienceTicks = 24;
// Alternations without progress that prove a broken wire.
constexpr uint8_t kReversals = 4;

uint8_t count_up(uint8_t value) {
  return value < UINT8_MAX ? static_cast<uint8_t>(value + 1) : value;
}
SCREED_OUT_OF_LINE uint16_t count_up(uint16_t value) {
  return value < UINT16_MAX ? static_cast<uint16_t>(value + 1) : value;
}

/// Counts the ticks that something goes on for, and tells whether it has done so for long enough.
SCREED_OUT_OF_LINE bool lasts(bool now, uint8_t& ticks, uint8_t enough) {
  ticks = now ? count_up(ticks) : static_cast<uint8_t>(0);
  return ticks >= enough;
}

}  // namespace

void TrackWatch::tick(int16_t duty, int16_t counts) {
  const int16_t push = duty < 0 ? static_cast<int16_t>(-duty) : duty;
  const int16_t backward = duty < 0 ? counts : static_cast<int16_t>(-counts);
  const bool near = backward >= -1 && backward <= 1;
  const int8_t behind =
      near ? static_cast<int8_t>(counts_behind_farthest_ + backward) : static_cast<int8_t>(-1);
  if (push < kPushDuty || behind < 0 || behind > 1) {
    counts_behind_farthest_ = 0;
    reversals_ = 0;
    still_ticks_ = 0;
    return;
  }
  counts_behind_farthest_ = behind;
  if (backward != 0) reversals_ = count_up(reversals_);
  still_ticks_ = push < kStallDuty ? static_cast<uint16_t>(0) : count_up(still_ticks_);
}

void TrackWatch::compare(int16_t duty, int16_t speed_dmm_per_s, uint16_t full_speed_mm_per_s) {
  const int16_t along = speed_dmm_per_s < 0 ? static_cast<int16_t>(-duty) : duty;
  const uint16_t speed = abs_i16(speed_dmm_per_s);
  const bool reversed = along <= static_cast<int16_t>(-kReverseDuty) &&
                        speed > static_cast<uint16_t>(kReversedSpeed * full_speed_mm_per_s);
  if (reversed ||
      (along < kPushDuty && speed > static_cast<uint16_t>(kDrivenSpeed * full_speed_mm_per_s))) {
    if (disobedience_ < kDisobedienceTicks) {
      disobedience_ = static_cast<uint8_t>(disobedience_ + (reversed ? 2 : 1));
    }
  } else {
    disobedience_ = 0;
  }
}

bool TrackWatch::disobeys() const {
  return disobedience_ >= kDisobedienceTicks;
}

bool TrackWatch::alternates() const {
  return reversals_ >= kReversals;
}

static_assert(Fault::kAccelMagChip == ChipBit::kAccelMagChip << 8 &&
                  Fault::kGyroChip == ChipBit::kGyroChip << 8,
              "faults of chips are their bits, shifted");

Supervisor::Supervisor(bool parameters_intact)
    : SupervisorMemory(), parameters_intact_(parameters_intact) {
  ticks_since_heartbeat_ = UINT16_MAX;
}

bool Supervisor::link_alive() const {
  return ticks_since_heartbeat_ <= kLinkStopTicks;
}

// Two witnesses: the estimator, which follows a roll by its gyro, and, at rest, the raw
// accelerometer, which also sees a robot that was turned over while the estimator was not looking.
// In motion the accelerometer alone is no witness: tipping over a crest the robot falls and brakes,
// and for a tenth of a second the force points anywhere. Tracks that slip on purpose brake it so
// evenly that it seems to rest; there it counts only while the estimator knows nothing.
bool Supervisor::tilted(const Parameters& parameters, const SupervisorInput& input) {
  const int16_t cos_limit_q15 = cos_q15(angle_from_centidegrees(parameters.tilt_limit));
  if (input.attitude_known) {
    if (input.cos_tilt_q14 < asr_i16(cos_limit_q15, 1)) return true;
    if (input.slips_on_purpose) return false;
  }
  // Scaled by 1/4 so that the sum of squares fits 32 bits: 1 g is 1024.
  uint32_t square = 0;
  for (uint8_t i = 0; i < 3; ++i) {
    if (abs_i16(input.gyro[i]) > kMaxRestGyro) return false;
    const int16_t part = asr_i16(input.accel[i], 2);
    square += static_cast<uint32_t>(mul_i16(part, part));
  }
  const uint16_t length = isqrt32(square);
  if (length < kMinRestAccel || length > kMaxRestAccel) return false;
  // length cos in Q15; four times the length, at most 1229, fits 16 bits.
  return asr_i16(input.accel[2], 2) <
         asr_i16(detail::high_half(mul_i16(static_cast<int16_t>(length * 4), cos_limit_q15)), 1);
}

uint16_t Supervisor::look_for_faults(const Parameters& parameters, const SupervisorInput& input) {
  // A change while it is not disarmed is checked as it is made, and the check takes time.
  const bool parameters_good =
      parameters_intact_ && (state_ != RobotState::kDisarmed || parameters.valid());
  uint16_t found = parameters_good ? 0 : static_cast<uint16_t>(Fault::kParameters);

  if (lasts(tilted(parameters, input), tilt_ticks_, kTiltTicks)) found |= Fault::kTilt;

  const bool new_gyro = (input.fresh & kFreshGyro) != 0;
  if (lasts(!new_gyro, silent_gyro_ticks_, kSilentTicks)) found |= Fault::kImuSilent;
  if (lasts((input.fresh & kFreshAccel) == 0, silent_accel_ticks_, kSilentTicks)) {
    found |= Fault::kImuSilent;
  }

  // The noise of a live gyro moves its last digit within a few samples.
  bool same = true;
  for (uint8_t i = 0; i < 3; ++i) {
    same = same && input.gyro[i] == last_gyro_[i];
    last_gyro_[i] = input.gyro[i];
  }
  if (new_gyro) frozen_gyro_ticks_ = same ? count_up(frozen_gyro_ticks_) : static_cast<uint8_t>(0);
  if (frozen_gyro_ticks_ >= kFrozenTicks) found |= Fault::kGyroFrozen;

  const auto failing = static_cast<uint8_t>(input.chips_failing & kVitalChips);
  if (lasts(failing != 0, chip_ticks_, kChipTicks)) {
    found |= static_cast<uint16_t>(static_cast<uint16_t>(failing) << 8);
  }

  left_.tick(input.duty_left, input.counts_left);
  right_.tick(input.duty_right, input.counts_right);
  const uint16_t stall_ticks = ticks_from_ms(parameters.stall_time);
  if (left_.still_ticks() >= stall_ticks) found |= Fault::kStallLeft;
  if (right_.still_ticks() >= stall_ticks) found |= Fault::kStallRight;
  if (left_.alternates()) found |= Fault::kEncoderLeft;
  if (right_.alternates()) found |= Fault::kEncoderRight;
  left_.compare(input.duty_left, input.speed_left_dmm_per_s, input.full_speed_mm_per_s);
  right_.compare(input.duty_right, input.speed_right_dmm_per_s, input.full_speed_mm_per_s);
  if (left_.disobeys()) found |= Fault::kMotorLeft;
  if (right_.disobeys()) found |= Fault::kMotorRight;

  stuck_for_ = input.stuck ? count_up(stuck_for_) : static_cast<uint16_t>(0);
  const uint16_t stuck_ticks = ticks_from_ms(parameters.stuck_time);
  if (input.gave_up || (stuck_ticks != 0 && stuck_for_ >= stuck_ticks)) found |= Fault::kStuck;
  if (input.lost) found |= Fault::kLost;

  if (lasts(input.battery_mv < static_cast<uint16_t>(parameters.battery_low), battery_ticks_,
            kBatteryTicks)) {
    found |= Fault::kBattery;
  }
  return found;
}

void Supervisor::watch_link() {
  ticks_since_heartbeat_ = count_up(ticks_since_heartbeat_);
  if (standalone_ || state_ == RobotState::kFault) return;
  if (ticks_since_heartbeat_ > kLinkDisarmTicks) {
    state_ = RobotState::kDisarmed;
  } else if (ticks_since_heartbeat_ > kLinkStopTicks && state_ == RobotState::kRunning) {
    state_ = RobotState::kStopped;
  }
}

// Arms and runs once, after the delay: a stand-alone robot that was stopped, even before that,
// stays stopped. ticks_since_start_ == UINT16_MAX: the start has happened or was cancelled.
void Supervisor::run_standalone(uint16_t delay_ticks) {
  if (!standalone_ || ticks_since_start_ == UINT16_MAX) return;
  if (ticks_since_start_ < delay_ticks) {
    ++ticks_since_start_;
    return;
  }
  if (request(Request::kArm) == RequestResult::kDone) {
    request(Request::kRun);
    ticks_since_start_ = UINT16_MAX;
  }
}

void Supervisor::tick(const Parameters& parameters, const SupervisorInput& input) {
  standalone_ = parameters.standalone != 0;
  estimator_ready_ = input.estimator_ready;
  present_ = look_for_faults(parameters, input);
  // Before anybody armed the robot a fault is no event: it only keeps the robot from being armed.
  if (present_ != 0 && state_ != RobotState::kDisarmed) {
    latched_ |= present_;
    state_ = RobotState::kFault;
  }
  watch_link();
  run_standalone(ticks_from_ms(parameters.standalone_delay));
}

RequestResult Supervisor::request(Request request) {
  // Whoever holds a stand-alone robot back before its start does not see it start by itself later.
  if (request == Request::kStop || request == Request::kDisarm ||
      request == Request::kEmergencyStop) {
    ticks_since_start_ = UINT16_MAX;
  }
  switch (request) {
    case Request::kArm:
      if (state_ != RobotState::kDisarmed) return RequestResult::kWrongState;
      if (present_ != 0) return RequestResult::kFaultPresent;
      // What the next look at the link would undo is not done in the first place.
      if (!standalone_ && !link_alive()) return RequestResult::kNoLink;
      if (!estimator_ready_) return RequestResult::kNotReady;
      state_ = RobotState::kArmed;
      return RequestResult::kDone;
    case Request::kRun:
      if (state_ != RobotState::kArmed && state_ != RobotState::kStopped) {
        return RequestResult::kWrongState;
      }
      if (!standalone_ && !link_alive()) return RequestResult::kNoLink;
      state_ = RobotState::kRunning;
      return RequestResult::kDone;
    case Request::kStop:
      if (state_ != RobotState::kRunning) return RequestResult::kWrongState;
      state_ = RobotState::kStopped;
      return RequestResult::kDone;
    case Request::kDisarm:
      if (state_ == RobotState::kFault) return RequestResult::kWrongState;
      state_ = RobotState::kDisarmed;
      return RequestResult::kDone;
    case Request::kClear:
      if (state_ != RobotState::kFault) return RequestResult::kWrongState;
      if (present_ != 0) return RequestResult::kFaultPresent;
      latched_ = 0;
      state_ = RobotState::kDisarmed;
      return RequestResult::kDone;
    case Request::kEmergencyStop:
      latched_ |= Fault::kEmergencyStop;
      state_ = RobotState::kFault;
      return RequestResult::kDone;
    case Request::kNone:
      break;
  }
  return RequestResult::kWrongState;
}

}  // namespace screed
