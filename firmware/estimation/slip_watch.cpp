// Slip and stuck, from belts, inertia and a network.
//
// A tick in real numbers. v: mean speed of the belts, a: specific force ahead, T = 0.01 s. Sums are
// in u = 0.048 mm/s, what two accelerometer counts gain in a tick.
//   residual   = dv - T (a - g sin pitch) - mean
//   mean      += residual / 64 while the tracks stand (0.64 s), / 512 while they turn (5 s)
//   loss_k    += residual - loss_k / 2^8, 2^10     leaky sums of 2.6 and 10 s; 0 at rest
//   vibration: x - its mean (0.64 s), clipped, low pass of 4 ticks, mean magnitude (0.64 s)
//   yaw rate, effort: low pass of 16 ticks
//   evidence  += ((held + 1) / 2 - evidence) / 16  every second tick: 0.32 s
#include "firmware/estimation/slip_watch.h"

#include "firmware/estimation/slip_model.h"

namespace screed {
namespace {

// Of evidence_, 65535 = 1: slips from 0.35 on; stuck from 0.73 on, until below 0.15.
constexpr uint16_t kSlipEvidence = 22938;
constexpr uint16_t kStuckEvidence = 47841;
constexpr uint16_t kFreeEvidence = 9830;
constexpr int16_t kStanding_dmm_per_s = 100;
constexpr int16_t kMaxVibration = 250;  // counts; 64 * 4 of it fit 16 bits
constexpr uint8_t kSmoothShift = 4;
constexpr int16_t kMaxEffort = 2000;  // duty, both tracks; 16 of it fit 16 bits

/// part / whole in Q14, limited to 16 bits; whole > 0.
SCREED_OUT_OF_LINE int16_t share_q14(uint16_t part, uint16_t whole) {
  return part / 2 >= whole
             ? static_cast<int16_t>(INT16_MAX)
             : static_cast<int16_t>(quotient_u16(static_cast<uint32_t>(part) << 14, whole));
}

constexpr int16_t negated_if(bool negated, int16_t value) {
  return negated ? static_cast<int16_t>(-value) : value;
}

}  // namespace

bool SlipWatch::slips() const {
  return evidence_ >= kSlipEvidence;
}

int16_t SlipWatch::velocity_loss_share(uint8_t which, bool backwards) const {
  const int16_t lost = saturate_i16(asr(velocity_loss_[which], 1));
  return negated_if(backwards != (lost < 0), share_q14(abs_i16(lost), faster_track_));
}

void SlipWatch::update_vibration(Vibration& vibration, int16_t counts) {
  const int32_t residual = counts - asr(vibration.mean, 6);
  vibration.mean += residual;
  const int16_t limited = limit_i16(residual, kMaxVibration);
  vibration.band_pass =
      static_cast<int16_t>(vibration.band_pass + limited - asr_i16(vibration.band_pass, 2));
  vibration.magnitude = static_cast<uint16_t>(vibration.magnitude + abs_i16(vibration.band_pass) -
                                              (vibration.magnitude >> 6));
}

void SlipWatch::tick(const TrackMotion& left, const TrackMotion& right, const int16_t* gyro,
                     const int16_t* accel, int16_t sin_pitch_q14, int32_t yaw_rate,
                     bool classify_now) {
  const int16_t half_left = asr_i16(left.speed_dmm_per_s, 1);
  const int16_t half_right = asr_i16(right.speed_dmm_per_s, 1);
  const uint16_t left_speed = abs_i16(half_left);
  const uint16_t right_speed = abs_i16(half_right);
  faster_track_ = static_cast<uint16_t>((left_speed < right_speed ? right_speed : left_speed) * 2);
  // A count of 0.244 mg over a tick is 0.239 of 0.1 mm/s. In two of these: the change of the belts'
  // speed minus that of the robot's. 16 bits, modulo: no track changes its speed by 1.6 m/s.
  const int16_t half_speed = asr_i16(static_cast<int16_t>(half_left + half_right), 1);
  const auto change = static_cast<int16_t>(half_speed - half_speed_);
  half_speed_ = half_speed;
  const auto gained = static_cast<uint16_t>(4U * static_cast<uint16_t>(change));
  const int32_t residual = static_cast<int16_t>(gained + asr_i16(change, 2) - asr_i16(accel[0], 1) +
                                                asr_i16(sin_pitch_q14, 3)) -
                           asr_i16(saturate_i16(asr(mean_, 8)), 1);
  // While the tracks stand the mean is learned quickly and nothing is lost; then it follows slowly.
  if (faster_track_ < kStanding_dmm_per_s) {
    mean_ += residual * 8;
    velocity_loss_[0] = 0;
    velocity_loss_[1] = 0;
  } else {
    mean_ += residual;
    velocity_loss_[0] += residual - asr(velocity_loss_[0], 8);
    velocity_loss_[1] += residual - asr(velocity_loss_[1], 10);
  }
  update_vibration(vibration_[0], gyro[1]);
  update_vibration(vibration_[1], accel[0]);
  update_vibration(vibration_[2], accel[2]);
  // Twice halved, so that a difference fits 16 bits.
  const int16_t rate = asr_i16(saturate_i16(asr(yaw_rate, 1)), 1);
  yaw_rate_ = static_cast<int16_t>(yaw_rate_ +
                                   asr_i16(static_cast<int16_t>(rate - yaw_rate_), kSmoothShift));
  const auto effort = static_cast<int16_t>(negated_if(half_left < 0, left.effort) +
                                           negated_if(half_right < 0, right.effort));
  effort_ = static_cast<int16_t>(effort_ + limit_i16(effort, kMaxEffort) -
                                 asr_i16(effort_, kSmoothShift));
  if (classify_now) classify(half_left, half_right, sin_pitch_q14);
}

void SlipWatch::classify(int16_t half_left, int16_t half_right, int16_t sin_pitch_q14) {
  const uint16_t faster = faster_track_;
  if (faster < kMinTrackSpeed_dmm_per_s) {
    evidence_ = 0;
    stuck_ = false;
    return;
  }
  const bool backwards = half_speed_ < 0;
  inputs_[0] = velocity_loss_share(0, backwards);
  inputs_[1] = velocity_loss_share(1, backwards);
  inputs_[2] =
      share_q14(static_cast<uint16_t>(mul_u16(abs_i16(yaw_rate_), arc_q16_) >> 16), faster);
  inputs_[3] = share_q14(abs_i16(static_cast<int16_t>(half_right - half_left)), faster);
  inputs_[4] = static_cast<int16_t>(faster >> 1);
  inputs_[5] = negated_if(backwards, sin_pitch_q14);
  inputs_[6] = effort_;
  for (uint8_t i = 0; i < 3; ++i)
    inputs_[7 + i] = static_cast<int16_t>(vibration_[i].magnitude >> 1);
  inputs_[10] = negated_if(backwards, saturate_i16(vibration_[0].mean));
  nn::model_slip::run_held(inputs_, &held_);

  // Halves, so that a difference fits 16 bits.
  const auto half_held = static_cast<int16_t>(asr_i16(held_, 1) + 16384);
  evidence_ = static_cast<uint16_t>(
      evidence_ +
      asr_i16(static_cast<int16_t>(half_held - static_cast<int16_t>(evidence_ >> 1)), 3));
  if (evidence_ >= kStuckEvidence) stuck_ = true;
  if (evidence_ < kFreeEvidence) stuck_ = false;
}

}  // namespace screed
