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
constexpr uint16_t kStallDuty = 110;
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
  const uint16_t push = abs_i16(duty);
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
  if (backward != 0 && reversals_ < kReversals) ++reversals_;
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
      disobedience_ = static_cast<uint8_t>(disobedience_ + 1 + (reversed ? 1 : 0));
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

SCREED_OUT_OF_LINE uint16_t TrackWatch::faults(int16_t duty, int16_t counts,
                                               int16_t speed_dmm_per_s,
                                               uint16_t full_speed_mm_per_s, uint16_t stall_ticks) {
  tick(duty, counts);
  compare(duty, speed_dmm_per_s, full_speed_mm_per_s);
  uint16_t found = 0;
  if (alternates()) found |= Fault::kEncoderLeft;
  if (disobeys()) found |= Fault::kMotorLeft;
  if (still_ticks_ >= stall_ticks) found |= Fault::kStallLeft;
  return found;
}

static_assert(Fault::kStallRight == Fault::kStallLeft << 1 &&
                  Fault::kEncoderRight == Fault::kEncoderLeft << 1 &&
                  Fault::kMotorRight == Fault::kMotorLeft << 1,
              "faults of the right track are those of the left one, shifted");
static_assert(Fault::kAccelMagChip == ChipBit::kAccelMagChip << 8 &&
                  Fault::kGyroChip == ChipBit::kGyroChip << 8,
              "faults of chips are their bits, shifted");

Supervisor::Supervisor(bool parameters_intact) : parameters_intact_(parameters_intact) {
  state_.ticks_since_heartbeat = UINT16_MAX;
}

bool Supervisor::link_alive() const {
  return state_.ticks_since_heartbeat <= kLinkStopTicks;
}

// Two witnesses: the estimator, which follows a roll by its gyro, and, at rest, the raw
// accelerometer, which also sees a robot that was turned over while the estimator was not looking.
// In motion the accelerometer alone is no witness: tipping over a crest the robot falls and brakes,
// and for a tenth of a second the force points anywhere. Tracks that slip on purpose brake it so
// evenly that it seems to rest; there it counts only while the estimator knows nothing.
bool Supervisor::tilted(const Parameters& parameters, const SupervisorInput& input) {
  const int16_t cos_limit_q15 = cos_q15(angle_from_centidegrees(parameters.tilt_limit()));
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
      parameters_intact_ && (state_.state != RobotState::kDisarmed || parameters.valid());
  uint16_t found = parameters_good ? 0 : static_cast<uint16_t>(Fault::kParameters);

  if (lasts(tilted(parameters, input), state_.tilt_ticks, kTiltTicks)) found |= Fault::kTilt;

  const bool new_gyro = (input.fresh & kFreshGyro) != 0;
  if (lasts(!new_gyro, state_.silent_gyro_ticks, kSilentTicks)) found |= Fault::kImuSilent;
  if (lasts((input.fresh & kFreshAccel) == 0, state_.silent_accel_ticks, kSilentTicks)) {
    found |= Fault::kImuSilent;
  }

  // The noise of a live gyro moves its last digit within a few samples.
  bool same = true;
  for (uint8_t i = 0; i < 3; ++i) {
    same = same && input.gyro[i] == state_.last_gyro[i];
    state_.last_gyro[i] = input.gyro[i];
  }
  if (new_gyro) lasts(same, state_.frozen_gyro_ticks, kFrozenTicks);
  if (state_.frozen_gyro_ticks >= kFrozenTicks) found |= Fault::kGyroFrozen;

  const auto failing = static_cast<uint8_t>(input.chips_failing & kVitalChips);
  if (lasts(failing != 0, state_.chip_ticks, kChipTicks)) {
    found |= static_cast<uint16_t>(static_cast<uint16_t>(failing) << 8);
  }

  const uint16_t stall_ticks = ticks_from_ms(parameters.stall_time());
  found |= state_.left.faults(input.duty_left, input.counts_left, input.speed_left_dmm_per_s,
                              input.full_speed_mm_per_s, stall_ticks);
  // The faults of the right track are the next bits.
  found |= static_cast<uint16_t>(state_.right.faults(input.duty_right, input.counts_right,
                                                     input.speed_right_dmm_per_s,
                                                     input.full_speed_mm_per_s, stall_ticks)
                                 << 1);

  state_.stuck_for = input.stuck ? count_up(state_.stuck_for) : static_cast<uint16_t>(0);
  const uint16_t stuck_ticks = ticks_from_ms(parameters.stuck_time());
  if (input.gave_up || (stuck_ticks != 0 && state_.stuck_for >= stuck_ticks))
    found |= Fault::kStuck;
  if (input.lost) found |= Fault::kLost;

  if (lasts(input.battery_mv < static_cast<uint16_t>(parameters.battery_low()),
            state_.battery_ticks, kBatteryTicks)) {
    found |= Fault::kBattery;
  }
  return found;
}

void Supervisor::watch_link() {
  state_.ticks_since_heartbeat = count_up(state_.ticks_since_heartbeat);
  if (state_.standalone || state_.state == RobotState::kFault) return;
  if (state_.ticks_since_heartbeat > kLinkDisarmTicks) {
    state_.state = RobotState::kDisarmed;
  } else if (state_.ticks_since_heartbeat > kLinkStopTicks &&
             state_.state == RobotState::kRunning) {
    state_.state = RobotState::kStopped;
  }
}

// Arms and runs once, after the delay: a stand-alone robot that was stopped, even before that,
// stays stopped. state_.ticks_since_start == UINT16_MAX: the start has happened or was
// cancelled.
void Supervisor::run_standalone(uint16_t delay_ticks) {
  if (!state_.standalone || state_.ticks_since_start == UINT16_MAX) return;
  if (state_.ticks_since_start < delay_ticks) {
    ++state_.ticks_since_start;
    return;
  }
  if (request(Request::kArm) == RequestResult::kDone) {
    request(Request::kRun);
    state_.ticks_since_start = UINT16_MAX;
  }
}

void Supervisor::tick(const Parameters& parameters, const SupervisorInput& input) {
  state_.standalone = parameters.standalone() != 0;
  state_.estimator_ready = input.estimator_ready;
  state_.present = look_for_faults(parameters, input);
  // Before anybody armed the robot a fault is no event: it only keeps the robot from being armed.
  if (state_.present != 0 && state_.state != RobotState::kDisarmed) {
    state_.latched |= state_.present;
    state_.state = RobotState::kFault;
  }
  watch_link();
  run_standalone(ticks_from_ms(parameters.standalone_delay()));
}

RequestResult Supervisor::request(Request request) {
  // Whoever holds a stand-alone robot back before its start does not see it start by itself later.
  if (request == Request::kStop || request == Request::kDisarm ||
      request == Request::kEmergencyStop) {
    state_.ticks_since_start = UINT16_MAX;
  }
  switch (request) {
    case Request::kArm:
      if (state_.state != RobotState::kDisarmed) return RequestResult::kWrongState;
      if (state_.present != 0) return RequestResult::kFaultPresent;
      // What the next look at the link would undo is not done in the first place.
      if (!state_.standalone && !link_alive()) return RequestResult::kNoLink;
      if (!state_.estimator_ready) return RequestResult::kNotReady;
      state_.state = RobotState::kArmed;
      return RequestResult::kDone;
    case Request::kRun:
      if (state_.state != RobotState::kArmed && state_.state != RobotState::kStopped) {
        return RequestResult::kWrongState;
      }
      if (!state_.standalone && !link_alive()) return RequestResult::kNoLink;
      state_.state = RobotState::kRunning;
      return RequestResult::kDone;
    case Request::kStop:
      if (state_.state != RobotState::kRunning) return RequestResult::kWrongState;
      state_.state = RobotState::kStopped;
      return RequestResult::kDone;
    case Request::kDisarm:
      if (state_.state == RobotState::kFault) return RequestResult::kWrongState;
      state_.state = RobotState::kDisarmed;
      return RequestResult::kDone;
    case Request::kClear:
      if (state_.state != RobotState::kFault) return RequestResult::kWrongState;
      if (state_.present != 0) return RequestResult::kFaultPresent;
      state_.latched = 0;
      state_.state = RobotState::kDisarmed;
      return RequestResult::kDone;
    case Request::kEmergencyStop:
      state_.latched |= Fault::kEmergencyStop;
      state_.state = RobotState::kFault;
      return RequestResult::kDone;
    case Request::kNone:
      break;
  }
  return RequestResult::kWrongState;
}

}  // namespace screed
