// Slip and stuck, from belts, inertia and a network.
#include "firmware/estimation/slip_watch.h"

#include "firmware/estimation/slip_model.h"

namespace screed {
namespace {

// Less motion than 0.55 of the belts' is evidence; what is missing is summed, in Q10 ticks,
// two ticks at a time.
constexpr int16_t kShare_q14 = 9011;
constexpr int16_t kSlipEvidence = 5 * 1024;
constexpr int16_t kStuckEvidence = 13 * 1024;
constexpr int16_t kMostEvidence = 28 * 1024;
constexpr int16_t kMostSpeedChange_dmm_per_s = 4000;
constexpr uint8_t kSmoothShift = 4;

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

void SlipWatch::tick(const TrackMotion& left, const TrackMotion& right, int16_t accel_x,
                     int16_t sin_pitch_q14, int32_t yaw_rate, bool judge) {
  const int16_t half_left = asr_i16(left.speed_dmm_per_s, 1);
  const int16_t half_right = asr_i16(right.speed_dmm_per_s, 1);
  const int16_t speed = static_cast<int16_t>(half_left + half_right);
  // A count of 0.244 mg over a tick is 0.239 of 0.1 mm/s. In two of these: the change of the belts'
  // speed minus that of the robot's, 16 bits.
  const int16_t half_speed = asr_i16(speed, 1);
  const int16_t change = clamp_i16(static_cast<int16_t>(half_speed - half_speed_),
                                   -kMostSpeedChange_dmm_per_s / 2, kMostSpeedChange_dmm_per_s / 2);
  half_speed_ = half_speed;
  const int16_t step = static_cast<int16_t>(4 * change + asr_i16(change, 2) - asr_i16(accel_x, 1) +
                                            asr_i16(sin_pitch_q14, 3));
  // Bias and the error of the pitch are in the mean, 2.6 s; what is left is forgotten in as much. A
  // robot that is stuck stays so until inertia tells of motion.
  const int16_t mean = static_cast<int16_t>(asr(mean_, 8));
  mean_ += static_cast<int32_t>(step) - mean;
  slip_ += static_cast<int32_t>(step) - mean;
  if (!stuck_) slip_ -= asr(slip_, 8);
  // Twice halved, so that a difference fits 16 bits.
  const int16_t rate = asr_i16(saturate_i16(asr(yaw_rate, 1)), 1);
  yaw_rate_ = static_cast<int16_t>(yaw_rate_ +
                                   asr_i16(static_cast<int16_t>(rate - yaw_rate_), kSmoothShift));
  effort_ = static_cast<int16_t>(effort_ + negated_if(half_left < 0, left.effort) +
                                 negated_if(half_right < 0, right.effort) -
                                 asr_i16(effort_, kSmoothShift));

  if (!judge) return;
  const uint16_t left_speed = abs_i16(half_left);
  const uint16_t right_speed = abs_i16(half_right);
  const auto faster =
      static_cast<uint16_t>((left_speed < right_speed ? right_speed : left_speed) * 2);
  if (faster < kSlowest_dmm_per_s) {
    inputs_[3] = 0;
    evidence_ = 0;
    stuck_ = false;
    return;
  }
  const bool back = speed < 0;
  const int16_t lost = saturate_i16(asr(slip_, 1));
  const int16_t lost_share = share_q14(abs_i16(lost), faster);
  inputs_[0] = negated_if(back != (lost < 0), lost_share);
  inputs_[1] =
      share_q14(static_cast<uint16_t>(mul_u16(abs_i16(yaw_rate_), arc_q16_) >> 16), faster);
  inputs_[2] = share_q14(abs_i16(static_cast<int16_t>(half_right - half_left)), faster);
  const auto fast = static_cast<int16_t>(faster < 4095 ? faster * 8 : INT16_MAX);
  inputs_[3] =
      static_cast<int16_t>(inputs_[3] + asr_i16(static_cast<int16_t>(fast - inputs_[3]), 3));
  inputs_[4] = negated_if(back, sin_pitch_q14);
  inputs_[5] = static_cast<int16_t>(clamp_i16(effort_, -8191, 8191) * 4);
  nn::model_slip::run_speed_share(inputs_, &share_q14_);

  // Tracks that gather speed take effort without being stuck.
  if (fast - inputs_[3] > asr_i16(fast, 3)) return;
  // Half of what is missing, so that it fits 16 bits.
  int16_t missing = static_cast<int16_t>(kShare_q14 / 2 - asr_i16(inputs_[1], 1));
  if (share_q14_ > 0) missing = static_cast<int16_t>(missing - asr_i16(share_q14_, 1));
  evidence_ = clamp_i16(static_cast<int16_t>(evidence_ + asr_i16(missing, 2)), 0, kMostEvidence);
  if (evidence_ >= kStuckEvidence) stuck_ = true;
  if (evidence_ == 0) stuck_ = false;
}

}  // namespace screed
