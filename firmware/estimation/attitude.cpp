// Attitude estimator in fixed point. See attitude.h and docs/attitude.md.
//
// The formats are chosen so that nearly every product is 32 x 16 bits with a shift by 16, the
// cheapest there is on the AVR. A rotation of one tick is rounded to 16 bits (7.6e-6 rad), and what
// rounding took is carried into the next tick, so nothing is lost over time. Corrections are
// rounded as well: what they leave stays in the filter.
//
// update() in real numbers, in the order of the code. T = 0.01 s, q = state_.orientation, E =
// to_earth (the matrix of q), g = kCountsPerG, n = the samples so far, counted up to a limit:
//   detect_rest           mean += (count - mean) / 2^kMeanShift
//                         at rest: |count - mean| < kRestGyro, kRestAccel for kRestTicks
//   learn_bias_at_rest    bias += (mean - bias) / (n + 1)
//   integrate             h = state_.half_angle = T (gyro - bias) / 2,  s = h^2
//                         q += q (-s/2, h (1 - s/6))       series of (cos |h|, h sin |h| / |h|)
//                         yaw_rate = (row 2 of E) 2 h / T
//   filter_gravity        difference = E accel - gravity
//                         slope += wn^2 difference - sqrt(2) wn slope,  gravity += slope
//                         at first gravity += difference / (n + 1)
//   correction            w = (1 - |q|^2) / 2,  x = gravity[1] / (2 g),  y = -gravity[0] / (2 g)
//   learn_bias_in_motion  bias -= 0.02/s T (E transposed) (x, y, 0)
//   trust                 f = (|mag|, m[2]),  field = f at first and after 20 s of distrust
//                         trusted: |f - field| < |mag| / 8 in both
//   heading_correction    m = E mag,  error = atan2(m[0], m[1]),  z = gain error / 2
//                         gain = 1 / (n + 1) at first, then T / 9 s a tick
//   correct               q += (w, x, y, z) q,  gravity turned about x and y by twice that
// Sources: Laidig and Seel 2023 (filter, rest, gains), Mahony, Hamel and Pflimlin 2008 (bias in
// motion); docs/studies/attitude.md has them in full.
#include "firmware/estimation/attitude.h"

#include <stddef.h>

#include "firmware/math/fixed.h"
#include "firmware/math/sqrt.h"

namespace screed {

namespace {

// Every constant has a physical meaning; none was fitted to a single recording.

constexpr int32_t kCountsPerG = 4096;  // 0.244 mg a count
constexpr uint8_t kGravityBits = 14;   // binary digits of state_.gravity
constexpr uint16_t kHalfAnglePerCount =
    52473;  // 70 mdps * 10 ms / 2 = 6.10865e-6 rad, 33 binary digits
constexpr int32_t kBiasLimit =
    22488429;  // 30 dps; the L3GD20H is specified to +-25 dps at this range

// Gravity filter: Butterworth, second order, time constant tau = 3 s; wn = sqrt(2) / tau * 0.01 s =
// 0.0047140:
//   slope += wn^2 (input - gravity) - sqrt(2) wn slope;  gravity += slope
constexpr int16_t kSquaredFrequency =
    373;  // wn^2 * 2^8 in Q16: 2^8 between the digits of state_.gravity and state_.slope
constexpr int16_t kDamping = 437;  // sqrt(2) wn in Q16

// Heading: time constant 9 s; at first the mean of all samples (gain 1/k); then at most 2
// degrees/s, so a piece of steel that passes by does little. Counted in magnetometer samples: at
// 100 samples/s, 300 are 3 s and 900 are 9 s.
constexpr uint16_t kHeadingStartSamples = 900;
constexpr uint16_t kHeadingLimitedFrom = 300;
constexpr uint16_t kHalfAnglePerAngle = 51472;  // pi / 65536 in Q30
constexpr uint16_t kHeadingGain = 57;           // 0.01 s / 9 s of that
constexpr int16_t kHeadingRateLimit = 2928;     // 0.02 degrees a tick as half angle in Q24
constexpr int16_t kMaxHalfAngle = 32767;        // Q24; can be negated
constexpr uint8_t kMagAgeLimit = 10;

// The field's strength and its vertical part may each change by an eighth of the strength, which
// for the inclination is 7 degrees and more. A field that stays different is taken for that of the
// site, as VQF does after 20 s.
constexpr uint8_t kFieldTolerance = 3;
constexpr uint16_t kFieldRelearnTicks = 2048;

// Rest: no axis differs from its own short mean (time constant 0.64 s) by more than this, for 1.5
// s.
constexpr uint8_t kMeanBits = 14;
constexpr uint8_t kMeanShift = 6;
constexpr uint32_t kRestGyro = static_cast<uint32_t>(29) << kMeanBits;       // 2 dps
constexpr uint32_t kRestAccel = static_cast<uint32_t>(200) << kMeanBits;     // 0.05 g
constexpr uint32_t kRestGyroMean = static_cast<uint32_t>(428) << kMeanBits;  // 30 dps
constexpr uint8_t kBiasTicks = 100;     // time constant of the bias at rest, 1 s
constexpr int16_t kMeanToBias = 26237;  // kHalfAnglePerCount / 2^14 / 2^3 in Q16

// Motion bias: 0.02/s of the rate at which gravity has to correct, as each axis sees it: 0.02 *
// 0.01 s * 2^3 in Q16, with 30 binary digits in and 33 out.
constexpr int16_t kMotionBiasGain = 105;

constexpr int16_t kYawRateScale = 16298;  // 2 * 100/s * 65536 / (2 pi) / 2^23 in Q16
constexpr int16_t kMdpsScale = 22381;     // 70 / kHalfAnglePerCount * 2^8 in Q16

constexpr uint32_t kMinAccelSquared = static_cast<uint32_t>(512) * 512;  // (1/8 g)^2

/// 1 / (n + 1) in Q16, n in 1..65534: the gain that turns a mean of n samples into one of n + 1.
int16_t mean_gain_q16(uint16_t n) {
  const uint16_t gain =
      static_cast<uint16_t>(static_cast<uint16_t>(0xFFFFU) / static_cast<uint16_t>(n + 1U));
  return static_cast<int16_t>(gain);
}

/// value * 2^kMeanBits, by a move of 16 bits and a short shift.
SCREED_OUT_OF_LINE int32_t with_mean_bits(int16_t value) {
  const uint32_t moved = static_cast<uint32_t>(static_cast<uint16_t>(value)) << 16;
  return asr(static_cast<int32_t>(moved), 16 - kMeanBits);
}

}  // namespace

void AttitudeEstimator::reset() {
  state_ = State{};
  state_.orientation = kIdentityQuaternion;
}

void AttitudeEstimator::update(const ImuSample& sample, bool may_be_at_rest) {
  const bool first = state_.ticks == 0;
  if (first && !align(sample.imu.accel())) return;
  detect_rest(sample, may_be_at_rest);
  if (at_rest()) learn_bias_at_rest();

  if (!first)
    integrate(sample.imu.gyro());  // the alignment is the pose at the end of this tick already
  const RotationMatrix to_earth = rotation_matrix(state_.orientation);
  state_.yaw_rate = scale_q16(asr(dot_q14(to_earth.row[2], state_.half_angle), 8), kYawRateScale);

  filter_gravity(to_earth, sample.imu.accel());
  // Half of the angle between the filtered acceleration and the vertical is y / (2 g) about x and
  // -x / (2 g) about y; with g = 2^12 counts and 14 digits that is 2^-3 in Q24. A filtered length
  // other than g only changes the gain.
  SmallQuaternion correction = {length_deficit_q24(state_.orientation),
                                limit_i16(asr_round(state_.gravity[1], 3), kMaxHalfAngle),
                                limit_i16(asr_round(-state_.gravity[0], 3), kMaxHalfAngle), 0};
  if (ready()) {
    state_.known = true;
    learn_bias_in_motion(to_earth, correction);
  }
  if (state_.mag_age < kMagAgeLimit) ++state_.mag_age;
  if (state_.mag_distrusted < UINT16_MAX) ++state_.mag_distrusted;
  if (sample.mag_fresh && trust(to_earth, sample.imu.mag())) {
    correction.z = heading_correction(to_earth, sample.imu.mag());
    state_.mag_distrusted = 0;
  }
  correct(correction);
}

/// Sets the shortest rotation that turns the measured acceleration upright. False: no acceleration
/// to speak of.
bool AttitudeEstimator::align(const int16_t (&accel)[3]) {
  const uint32_t squared = squared_length(accel);
  if (squared < kMinAccelSquared) return false;
  // For a = (ax, ay, az) of length n: q is along (n + az, ay, -ax, 0). Upside down that vanishes,
  // so then the pose is first rolled by half a turn, which changes the signs of ay and az and swaps
  // the components in pairs, with a minus at the first and at the last.
  const uint8_t upside_down = accel[2] < 0 ? 1 : 0;
  const auto az = static_cast<int32_t>(abs_i16(accel[2]));
  // Quartered they fit 16 bits, and the squares of clipped values 32. A count that changes its
  // sign, once or twice, is rounded up.
  constexpr int32_t kRoundUp = 3;
  int16_t direction[3] = {static_cast<int16_t>(asr(isqrt32(squared) + az, 2)),
                          static_cast<int16_t>(asr(accel[1] + kRoundUp * upside_down, 2)),
                          static_cast<int16_t>(asr(accel[0] + kRoundUp, 2))};
  if (upside_down == 0) direction[2] = static_cast<int16_t>(-direction[2]);
  const uint16_t length = isqrt32(squared_length(direction));
  const auto scale = static_cast<int32_t>(
      quotient_u32(static_cast<uint32_t>(kQ30One), static_cast<uint16_t>(length + 1U)));
  int32_t* const q = components(state_.orientation);
  for (uint8_t i = 0; i < 4; ++i) q[i ^ upside_down] = i == 3 ? 0 : direction[i] * scale;
  state_.gravity[0] = 0;
  state_.gravity[1] = 0;
  state_.gravity[2] = kCountsPerG << kGravityBits;
  return true;
}

/// Follows the short means and counts the ticks of standstill.
void AttitudeEstimator::detect_rest(const ImuSample& sample, bool may_be_at_rest) {
  bool quiet = may_be_at_rest;
  for (uint8_t i = 0; i < 6; ++i) {
    const bool of_gyro = i < 3;
    const int32_t count = with_mean_bits(sample.imu.all[i]);
    int32_t mean = state_.ticks == 0 ? count : state_.mean[i];
    const int32_t change = count - mean;
    mean += asr_round(change, kMeanShift);
    state_.mean[i] = mean;
    if (abs_u32(change) > (of_gyro ? kRestGyro : kRestAccel) ||
        (of_gyro && abs_u32(mean) > kRestGyroMean)) {
      quiet = false;
    }
  }
  if (!quiet) {
    state_.rest_ticks = 0;
  } else if (state_.rest_ticks < kRestTicks) {
    ++state_.rest_ticks;
  }
}

SCREED_OUT_OF_LINE void AttitudeEstimator::forget_slope() {
  state_.slope[0] = state_.slope[1] = state_.slope[2] = 0;
}

/// Moves the bias to the mean of the gyroscope.
void AttitudeEstimator::learn_bias_at_rest() {
  if (state_.bias_samples == 0) {
    // The bias may have turned the estimate by many degrees until now: average gravity and north
    // anew.
    forget_slope();
    state_.ticks = 1;
    if (state_.mag_samples != 0) state_.mag_samples = 1;
  }
  if (state_.bias_samples < kBiasTicks) ++state_.bias_samples;
  const int16_t gain = mean_gain_q16(state_.bias_samples);
  for (uint8_t i = 0; i < 3; ++i) {
    state_.bias[i] += scale_q16(scale_q16(state_.mean[i] * 8, kMeanToBias) - state_.bias[i], gain);
  }
}

/// A bias makes gravity correct in the same direction again and again, seen from the sensor.
void AttitudeEstimator::learn_bias_in_motion(const RotationMatrix& to_earth,
                                             const SmallQuaternion& correction) {
  for (uint8_t i = 0; i < 3; ++i) {
    const int32_t seen =
        mul_i16(to_earth.row[0][i], correction.x) + mul_i16(to_earth.row[1][i], correction.y);
    state_.bias[i] =
        limit_i32(state_.bias[i] - scale_q16(asr(seen, 8), kMotionBiasGain), kBiasLimit);
  }
}

/// Turns the orientation by what the gyroscope measured in this tick.
void AttitudeEstimator::integrate(const int16_t (&gyro)[3]) {
  for (uint8_t i = 0; i < 3; ++i) {
    int32_t& exact = state_.exact[i];
    exact = detail::mul_su(gyro[i], kHalfAnglePerCount) - state_.bias[i] +
            static_cast<int32_t>(detail::low_half(exact));
    state_.half_angle[i] = detail::high_half(exact);
  }
  // With h the half angle and s = h^2: cos h - 1 = -s/2 and sin(h)/h - 1 = -s/6; at the gyroscope's
  // limit of 2000 dps about one axis the rest of the series changes the angle by 3e-5 of it.
  const int32_t squared = dot_q14(state_.half_angle, state_.half_angle);  // 34 digits: below 0.13
  const int16_t s = detail::high_half(squared + 0x8000);                  // 18 digits
  const int16_t shrink = detail::high_half(mul_i16(s, 10923) + 0x8000);   // s / 6, 18 digits
  SmallQuaternion change;                                                 // 17 digits
  change.w = static_cast<int16_t>(-asr_i16(s, 2));
  int16_t* sine = &change.x;
  for (int32_t& exact : state_.exact) {
    exact -= asr_round(scale_q16(exact, shrink), 2);
    *sine++ = detail::high_half(exact);
  }
  turn_by_sensor(state_.orientation, change);
}

void AttitudeEstimator::filter_gravity(const RotationMatrix& to_earth, const int16_t (&accel)[3]) {
  const bool starting = state_.ticks < kStartTicks;
  if (starting) ++state_.ticks;
  const int16_t start_gain = starting ? mean_gain_q16(state_.ticks) : static_cast<int16_t>(0);
  for (uint8_t i = 0; i < 3; ++i) {
    const int32_t difference = dot_q14(to_earth.row[i], accel) - state_.gravity[i];
    if (starting) {  // the mean of all samples so far
      state_.gravity[i] += scale_q16(difference, start_gain);
    } else {
      state_.slope[i] +=
          scale_q16(difference, kSquaredFrequency) - scale_q16(state_.slope[i], kDamping);
      state_.gravity[i] += asr_round(state_.slope[i], 8);
    }
  }
}

/// The field is that of the site, as far as its strength and its vertical part tell.
bool AttitudeEstimator::trust(const RotationMatrix& to_earth, const int16_t (&mag)[3]) {
  const int16_t seen[2] = {static_cast<int16_t>(isqrt32(squared_length(mag)) >> 2),
                           detail::high_half(dot_q14(to_earth.row[2], mag))};
  const bool learning =
      state_.mag_samples < kHeadingLimitedFrom || state_.mag_distrusted > kFieldRelearnTicks;
  bool trusted = true;
  for (uint8_t i = 0; i < 2; ++i) {
    if (learning) state_.field[i] = seen[i];
    const auto change = static_cast<int16_t>(seen[i] - state_.field[i]);
    if (abs_i16(change) >= static_cast<uint16_t>(seen[0]) >> kFieldTolerance) trusted = false;
  }
  return trusted;
}

uint8_t AttitudeEstimator::heading_sigma() const {
  return state_.mag_samples == 0 ? UINT8_MAX
                                 : static_cast<uint8_t>(4 + (state_.mag_distrusted >> 11));
}

/// Half angle about the vertical, Q24, by which the magnetometer pulls its horizontal part to
/// north.
int16_t AttitudeEstimator::heading_correction(const RotationMatrix& to_earth,
                                              const int16_t (&mag)[3]) {
  const Angle error = atan2_angle(dot_q14(to_earth.row[0], mag), dot_q14(to_earth.row[1], mag));
  const auto age = static_cast<int16_t>(state_.mag_age);
  state_.mag_age = 0;
  if (state_.mag_samples ==
      0) {  // the first sample may be any angle away: turned at once and exactly
    state_.mag_samples = 1;
    const Angle half = static_cast<Angle>(asr(error, 1));
    turn_at_once(state_.orientation, {cos_q15(half), 0, 0, sin_q15(half)});
    return 0;
  }
  auto gain = static_cast<int16_t>(kHeadingGain * age);
  auto limit = static_cast<int16_t>(kHeadingRateLimit * age);
  if (state_.mag_samples < kHeadingLimitedFrom) limit = kMaxHalfAngle;
  if (state_.mag_samples < kHeadingStartSamples) {
    ++state_.mag_samples;
    gain = static_cast<int16_t>(kHalfAnglePerAngle / state_.mag_samples);
  }
  return limit_i16(asr_round(mul_i16(error, gain), 6), limit);
}

/// Turns the estimate about the earth's axes, and the filtered gravity with it, so that nothing is
/// corrected twice.
void AttitudeEstimator::correct(const SmallQuaternion& correction) {
  turn_by_earth(state_.orientation, correction);
  // Only the vertical component moves anything: the others are what is left of the last correction.
  // For the whole angle; with the digits of scale_q16 and Q24 that leaves 2^7.
  state_.gravity[0] += asr_round(scale_q16(state_.gravity[2], correction.y), 7);
  state_.gravity[1] -= asr_round(scale_q16(state_.gravity[2], correction.x), 7);
  // Gravity that does not point up any more is a lost attitude (tumbling beyond the gyroscope's
  // range): start again.
  if (state_.gravity[2] < (kCountsPerG / 4) << kGravityBits) {
    forget_slope();
    state_.ticks = 0;
    state_.mag_samples = 0;
  }
}

AttitudeAngles AttitudeEstimator::angles() const {
  const RotationMatrix to_earth = rotation_matrix(state_.orientation);
  const int16_t left = to_earth.row[2][1];
  const int16_t up = to_earth.row[2][2];
  const uint16_t level = isqrt32(static_cast<uint32_t>(mul_i16(left, left) + mul_i16(up, up)));
  return {atan2_angle(left, up), atan2_angle(to_earth.row[2][0], static_cast<int32_t>(level)),
          atan2_angle(to_earth.row[1][0], to_earth.row[0][0]), to_earth.row[2][0], up};
}

int32_t AttitudeEstimator::gyro_bias_mdps(uint8_t axis) const {
  return scale_q16(asr(state_.bias[axis], 8), kMdpsScale);
}

}  // namespace screed
