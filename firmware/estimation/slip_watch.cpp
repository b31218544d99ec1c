// Slip and stuck, from belts, inertia and a network.
//
// A tick in real numbers. v: mean speed of the belts, a: specific force ahead, T = 0.01 s. Sums are
// in u = 0.048 mm/s, what two accelerometer counts gain in a tick.
//   residual   = dv - T (a - g sin pitch) - mean
//   mean      += residual / 64 while the tracks stand (0.64 s), / 512 while they turn (5 s)
//   loss_k    += residual - loss_k / 2^6, 2^8, 2^10  leaky sums of 0.6, 2.6 and 10 s; 0 at rest
//   lost      += residual - lost / 4              of the last few ticks, for collisions
//   vibration: x - its mean (0.64 s), clipped, low pass of 4 ticks, mean magnitude (0.16 s)
//   yaw rate: low pass of 16 ticks; effort: of 8
//   evidence  += ((held + 1) / 2 - evidence) / 4  every fourth tick: 0.16 s
#include "firmware/estimation/slip_watch.h"

#include <string.h>

#include "firmware/estimation/slip_model.h"
#include "nn/infer/gated.h"

namespace screed {
namespace {

constexpr int16_t kMaxResidual = 8000;   // four of them fit 16 bits
constexpr uint16_t kMinHalfSpeed = 250;  // 50 mm/s
constexpr int16_t kMaxVibration = 250;   // counts; 64 * 4 of it fit 16 bits
constexpr uint8_t kYawShift = 4;
constexpr uint8_t kEffortShift = 3;
constexpr int16_t kMaxEffort = 2000;  // duty, both tracks; 8 of it fit 16 bits
constexpr nn::GatedShape kShape = {kSlipInputs, kSlipUnits, kSlipOutputs};
static_assert(sizeof nn::model_slip::parameters == kShape.size(), "a network of another shape");

/// part / whole in Q7, 0..127; whole > 0.
SCREED_OUT_OF_LINE int8_t share_q7(uint16_t part, uint16_t whole) {
  return part >= whole ? INT8_MAX : static_cast<int8_t>(quotient_u16(mul_u16(part, 128), whole));
}

/// 32 log2(value / 2^10) with straight lines between the powers, limited to a byte.
int8_t logarithm_q5(uint16_t value) {
  if (value < 64) return INT8_MIN;
  if (value >= 0x4000) return INT8_MAX;
  int16_t result = 3 * 32;  // of 2^13
  while (value < 0x2000) {
    value = static_cast<uint16_t>(value << 1);
    result = static_cast<int16_t>(result - 32);
  }
  return static_cast<int8_t>(result + static_cast<int16_t>(value >> 8) - 32);
}

SCREED_OUT_OF_LINE int8_t byte_of(int16_t value) {
  return static_cast<int8_t>(clamp_i16(value, -INT8_MAX, INT8_MAX));
}

constexpr int16_t negated_if(bool negated, int16_t value) {
  return negated ? static_cast<int16_t>(-value) : value;
}

}  // namespace

bool SlipWatch::slips() const {
  return state_.evidence >= nn::model_slip::kSlipEvidence;
}

void SlipWatch::update_vibration(Vibration& vibration, int16_t counts) {
  const int32_t residual = counts - asr(vibration.mean, 6);
  vibration.mean += residual;
  const int16_t limited = limit_i16(residual, kMaxVibration);
  vibration.band_pass =
      static_cast<int16_t>(vibration.band_pass + limited - asr_i16(vibration.band_pass, 2));
  vibration.magnitude = static_cast<uint16_t>(vibration.magnitude + abs_i16(vibration.band_pass) -
                                              (vibration.magnitude >> 4));
}

/// What the robot drives against takes half of its speed, or more, within a few ticks, while its
/// tracks go on.
SCREED_OUT_OF_LINE void SlipWatch::feel_collision(int16_t residual) {
  state_.lost = static_cast<int16_t>(state_.lost - asr_i16(state_.lost, 2) + residual);
  const uint16_t fast = abs_i16(state_.half_speed);
  // Half the speed is half of 4.2 for each half of 0.1 mm/s.
  if (fast >= kMinHalfSpeed && abs_i16(state_.lost) >> 1 >= fast) {
    state_.collision_ticks = kCollisionTicks;
  } else if (state_.collision_ticks != 0) {
    --state_.collision_ticks;
  }
}

/// What was lost, and the network's memory.
void SlipWatch::forget() {
  state_.memory = {};
  memset(state_.values + kSlipInputs, 0, kSlipUnits);
}

void SlipWatch::pass_over(const TrackMotion& left, const TrackMotion& right) {
  state_.half_speed = asr_i16(
      static_cast<int16_t>(asr_i16(left.speed_dmm_per_s, 1) + asr_i16(right.speed_dmm_per_s, 1)),
      1);
  forget();
  state_.lost = 0;
  state_.collision_ticks = 0;
  state_.evidence = 0;
  state_.stuck = false;
  state_.half_done = false;
  state_.travel_share = 0;
}

void SlipWatch::tick(const TrackMotion& left, const TrackMotion& right, const int16_t* gyro,
                     const int16_t* accel, int16_t sin_pitch_q14, int32_t yaw_rate,
                     bool classify_now) {
  const int16_t half_left = asr_i16(left.speed_dmm_per_s, 1);
  const int16_t half_right = asr_i16(right.speed_dmm_per_s, 1);
  const auto effort = static_cast<int16_t>(negated_if(half_left < 0, left.effort) +
                                           negated_if(half_right < 0, right.effort));
  state_.effort = static_cast<int16_t>(state_.effort + clamp_i16(effort, -kMaxEffort, kMaxEffort) -
                                       asr_i16(state_.effort, kEffortShift));
  // Twice halved, so that a difference fits 16 bits.
  const int16_t rate = asr_i16(saturate_i16(asr(yaw_rate, 1)), 1);
  state_.yaw_rate = static_cast<int16_t>(
      state_.yaw_rate + asr_i16(static_cast<int16_t>(rate - state_.yaw_rate), kYawShift));
  update_vibration(state_.vibration[0], gyro[1]);
  update_vibration(state_.vibration[1], accel[0]);
  update_vibration(state_.vibration[2], accel[2]);
  const uint16_t left_speed = abs_i16(half_left);
  const uint16_t right_speed = abs_i16(half_right);
  state_.faster_track =
      static_cast<uint16_t>((left_speed < right_speed ? right_speed : left_speed) * 2);
  // A count of 0.244 mg over a tick is 0.239 of 0.1 mm/s. In two of these: the change of the belts'
  // speed minus that of the robot's. 16 bits, modulo: no track changes its speed by 1.6 m/s.
  const int16_t half_speed = asr_i16(static_cast<int16_t>(half_left + half_right), 1);
  const auto change = static_cast<int16_t>(half_speed - state_.half_speed);
  state_.half_speed = half_speed;
  const auto gained = static_cast<uint16_t>(4U * static_cast<uint16_t>(change));
  const int32_t residual = static_cast<int16_t>(gained + asr_i16(change, 2) - asr_i16(accel[0], 1) +
                                                asr_i16(sin_pitch_q14, 3)) -
                           asr_i16(saturate_i16(asr(state_.mean, 8)), 1);
  feel_collision(limit_i16(residual, kMaxResidual));
  // While the tracks stand the mean is learned quickly and nothing is lost; then it follows slowly.
  int32_t learned = residual;
  if (state_.faster_track < kStanding_dmm_per_s) {
    learned *= 8;
    forget();
  } else {
    for (uint8_t i = 0; i < 3; ++i)
      state_.memory.velocity_loss[i] +=
          residual - asr(state_.memory.velocity_loss[i], static_cast<uint8_t>(6 + 2 * i));
  }
  state_.mean += learned;
  if (!classify_now) return;
  if (state_.faster_track < kMinTrackSpeed_dmm_per_s) {
    state_.evidence = 0;
    state_.stuck = false;
    state_.travel_share = UINT8_MAX;
    state_.half_done = false;
    return;
  }
  state_.half_done = !state_.half_done;
  if (state_.half_done) {
    set_inputs(half_left, half_right, sin_pitch_q14);
    nn::gated_candidates(kShape, nn::model_slip::parameters, state_.values, state_.candidates);
  } else {
    conclude();
  }
}

void SlipWatch::set_inputs(int16_t half_left, int16_t half_right, int16_t sin_pitch_q14) {
  const bool backwards = state_.half_speed < 0;
  for (uint8_t i = 0; i < 3; ++i) {
    const int16_t lost = saturate_i16(asr(state_.memory.velocity_loss[i], 1));
    const int8_t share = share_q7(abs_i16(lost), state_.faster_track);
    // Negative where the signs differ.
    state_.values[i] = (state_.half_speed ^ lost) < 0 ? static_cast<int8_t>(-share) : share;
  }
  state_.values[3] =
      share_q7(static_cast<uint16_t>(mul_u16(abs_i16(state_.yaw_rate), arc_q16_) >> 16),
               state_.faster_track);
  state_.values[4] =
      share_q7(abs_i16(static_cast<int16_t>(half_right - half_left)), state_.faster_track);
  state_.values[5] = byte_of(static_cast<int16_t>(state_.faster_track >> 5));
  state_.values[6] = byte_of(negated_if(backwards, asr_i16(sin_pitch_q14, 6)));
  state_.values[7] = byte_of(asr_i16(state_.effort, 3));
  for (uint8_t i = 0; i < 3; ++i)
    state_.values[8 + i] = logarithm_q5(state_.vibration[i].magnitude);
  state_.values[11] =
      byte_of(negated_if(backwards, saturate_i16(asr(state_.vibration[0].mean, 6))));
}

void SlipWatch::conclude() {
  int16_t outputs[kSlipOutputs];
  nn::gated_update(kShape, nn::model_slip::parameters, state_.values, state_.candidates,
                   state_.memory.states, outputs);
  state_.evidence = slip_evidence(state_.evidence, outputs[0]);
  if (state_.evidence >= nn::model_slip::kStuckEvidence) state_.stuck = true;
  if (state_.evidence < nn::model_slip::kFreeEvidence) state_.stuck = false;
  state_.travel_share = static_cast<uint8_t>(clamp_i16(asr_i16(outputs[1], 4), 0, UINT8_MAX));
}

}  // namespace screed
