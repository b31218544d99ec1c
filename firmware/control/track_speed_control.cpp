// Speed control of one track.
//
// A tick in real numbers, in the order of the code; T = 0.01 s:
//   e           = lag + counts - speed             alpha-beta filter, in counts
//   lag         = (1 - alpha) e;  speed += beta e
//   halfway    += (1 - r) (target - halfway);  expected += (1 - r) (halfway - expected)
//   error       = expected - speed
//   integral   += ki T error                       not further out while the duty is at its limit
//   duty        = feed-forward target nominal / supply + kp error + integral
#include "firmware/control/track_speed_control.h"

#include "firmware/math/fixed.h"
#include "hal/sample.h"

namespace screed {
namespace {

// Gains of the alpha-beta filter with both poles at r = 0.837: alpha = 1 - r^2, beta = (1 - r)^2
// (Kalata 1984, fading memory).
constexpr int32_t kAlpha_q8 = 77;
constexpr int32_t kBeta_q12 = 109;
// 1 - r: two first-order lags with this gain follow a target as that filter follows a speed.
constexpr int32_t kLag_q8 = 42;
// Below this speed a track with target 0 counts as standing.
constexpr int16_t kStanding_dmm_per_s = 100;
constexpr int32_t kIntegralLimit_q16 = static_cast<int32_t>(kDutyMax) << 16;
// Limits of the error, so that its product with the largest gain fits 32 bits.
constexpr int16_t kErrorLimit_dmm_per_s = 3000;

}  // namespace

TrackSpeedControl::TrackSpeedControl(const BoardConstants& board, const Parameters& parameters)
    : OwnBoard(board), parameters_(parameters) {}

int16_t TrackSpeedControl::feed_forward_q8() const {
  return static_cast<int16_t>(static_cast<uint32_t>(kDutyMax) * 256 / board().full_speed_mm_per_s);
}

SCREED_OUT_OF_LINE void TrackSpeedControl::release(int16_t counts) {
  state_.control = {};
  state_.motion.effort = 0;
  observe(counts);
}

int32_t TrackSpeedControl::expect(int16_t target_mm_per_s) {
  int32_t target_q4 = mul_i16(target_mm_per_s, 160);
  for (int32_t& lagging : state_.control.lagging_q4) {
    lagging += asr_round((target_q4 - lagging) * kLag_q8, 8);
    target_q4 = lagging;
  }
  return target_q4;
}

void TrackSpeedControl::observe(int16_t counts) {
  const int32_t step_q12 = mul_i16(counts, 4096);
  const int32_t error = state_.lag_q12 + step_q12 - state_.speed_q12;
  state_.lag_q12 = error - asr(error * kAlpha_q8, 8);
  // The filter's error stays within a few hundred counts; in Q12 its product with beta needs the
  // shift in two parts.
  state_.speed_q12 += asr(asr(error, 2) * kBeta_q12, 10);
  // counts/tick Q12 * um Q4 * 100 ticks/s = 0.1 mm/s Q16, from the speed's upper and lower 16 bits:
  // noise at the limit is 5.7 m/s on the Rover 5, and that product passes 32 bits.
  const int32_t whole = detail::mul_su(detail::high_half(state_.speed_q12), board().count_um_q4);
  const uint32_t part = mul_u16(detail::low_half(state_.speed_q12), board().count_um_q4) >> 16;
  state_.motion.speed_dmm_per_s = saturate_i16(whole + static_cast<int32_t>(part));
}

int16_t TrackSpeedControl::tick(int16_t target_mm_per_s, int16_t counts, uint16_t battery_mv) {
  observe(counts);
  const int32_t expected_q4 = expect(target_mm_per_s);
  const bool standing = state_.motion.speed_dmm_per_s < kStanding_dmm_per_s &&
                        state_.motion.speed_dmm_per_s > static_cast<int16_t>(-kStanding_dmm_per_s);
  if (target_mm_per_s == 0 && standing) {
    state_.control.integral_q16 = 0;
    state_.motion.effort = 0;
    return 0;
  }

  const int16_t error =
      limit_i16(asr_round(expected_q4, 4) - state_.motion.speed_dmm_per_s, kErrorLimit_dmm_per_s);

  // Feed-forward: duty that drives the unloaded track at the target, with the voltage there is. A
  // lower reading than half the nominal one is implausible; limits the compensation to twice.
  const auto least_mv = static_cast<uint16_t>(board().motor_nominal_mv / 2);
  const uint16_t supply_mv = battery_mv < least_mv ? least_mv : battery_mv;
  const auto nominal_q4 = static_cast<int16_t>(asr(mul_i16(target_mm_per_s, feed_forward_q8()), 4));
  const int32_t feed_forward_q10 =
      mul_i16(nominal_q4, static_cast<int16_t>(quotient_u16(
                              static_cast<uint32_t>(board().motor_nominal_mv) * 64, supply_mv)));
  // kp/16 duty per mm/s on an error in 0.1 mm/s: kp e / 160 = kp e 102 / 2^14.
  const int32_t proportional = asr(mul_i16(parameters_.speed_kp(), error) * 102, 14);
  // The target is within the full speed: this is 800 at most, the proportional part 5976.
  const auto feed_forward = static_cast<int16_t>(asr(feed_forward_q10, 10));
  const auto without_integral =
      static_cast<int16_t>(feed_forward + static_cast<int16_t>(proportional));

  // ki/16 duty per mm: each tick adds ki e / 16 / 10 / 100 duty = ki e 131 / 32 in Q16. While the
  // duty is at its limit the integral only moves back from it.
  const auto unlimited =
      static_cast<int16_t>(without_integral + detail::high_half(state_.control.integral_q16));
  const bool pushes_out =
      (unlimited >= kDutyMax && error > 0) || (unlimited <= -kDutyMax && error < 0);
  if (!pushes_out) {
    state_.control.integral_q16 = limit_i32(
        state_.control.integral_q16 + asr(mul_i16(parameters_.speed_ki(), error) * 131, 5),
        kIntegralLimit_q16);
  }
  const int16_t duty = limit_i16(
      static_cast<int16_t>(without_integral + detail::high_half(state_.control.integral_q16)),
      kDutyMax);
  state_.motion.effort = static_cast<int16_t>(duty - feed_forward);
  return duty;
}

}  // namespace screed
