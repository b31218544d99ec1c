// Where the robot is, and how well it knows.
#include "firmware/estimation/position_estimate.h"

#include <string.h>

#include "firmware/math/fixed.h"
#include "firmware/math/sqrt.h"
#include "firmware/math/trig.h"
#include "firmware/parameters/board_constants.h"

namespace screed {

namespace {

/// Variance of (256 mm)^2.
constexpr uint32_t kDoubt = 1UL << 28;

/// The share of all travel that makes noise, of 256.
constexpr uint16_t kAlwaysLost = 8;

/// length * factor (Q15), rounded; |length| below 2^30.
SCREED_OUT_OF_LINE int32_t times_q15(int32_t length, int16_t factor) {
  return scale_q16(length * 2, factor);
}

/// At most 2^31 - 1. The sum before does not wrap: what is added is below 2^29.
uint32_t limited(uint32_t variance) {
  return static_cast<int32_t>(variance) < 0 ? static_cast<uint32_t>(INT32_MAX) : variance;
}

}  // namespace

void PositionEstimate::reset() {
  state_ = State{};
}

void PositionEstimate::update(int16_t counts_left, int16_t counts_right, Angle heading, Angle pitch,
                              uint8_t share) {
  // Mean of both tracks: half the sum; Q4, the half and the share together are a shift by 13, of
  // which 16 are in the scaling; 2^-13 mm are 8.192 a um: 8 times 131 / 128, less 0.05 %.
  const int32_t both =
      detail::mul_su(static_cast<int16_t>(counts_left + counts_right), count_um_q4_);
  const auto scale = static_cast<int16_t>(static_cast<uint16_t>((share + 1) * 131) >> 1);
  const int32_t travel = scale_q16(both, scale);
  const int32_t horizontal = times_q15(travel, cos_q15(pitch));
  state_.place[kX] += times_q15(horizontal, cos_q15(heading));
  state_.place[kY] += times_q15(horizontal, sin_q15(heading));

  // Of both tracks, so that a turn on the spot makes the place uncertain as well. In 16 um: 16000
  // of it, 128 mm of both, make the parameter's unit; in Q16 that is 4.1 for each, taken as 4.
  const auto travelled =
      static_cast<uint16_t>(static_cast<uint8_t>(abs_i16(counts_left) + abs_i16(counts_right)) *
                            static_cast<uint16_t>(count_um_q4_ >> 8));
  const auto lost = static_cast<uint16_t>(UINT8_MAX + kAlwaysLost - share);
  const auto noise = static_cast<uint16_t>(mul_u16(noise_x4_, lost) >> 8);
  const uint32_t growth = mul_u16(travelled, noise);
  for (uint32_t& variance : state_.variance) variance = limited(variance + growth);
}

void PositionEstimate::keep_inside(const int16_t* half_mm) {
  // The upper half of a place is in 8 mm, on a machine whose lower byte comes first. Two bytes are
  // cheaper to compare and to change than four.
  auto* upper = reinterpret_cast<uint8_t*>(state_.place) + 2;
  for (const int16_t* const end = half_mm + 2; half_mm != end; ++half_mm) {
    const auto half = static_cast<int16_t>(static_cast<uint16_t>(*half_mm) >> 3);
    int16_t place = 0;
    memcpy(&place, upper, sizeof(place));
    if (half != 0) place = clamp_i16(place, static_cast<int16_t>(-half), half);
    memcpy(upper, &place, sizeof(place));
    upper += sizeof(state_.place[0]);
  }
}

bool PositionEstimate::measure(uint8_t axis, int16_t z_mm, int16_t sigma_mm, uint8_t gate) {
  int32_t& place = state_.place[axis];
  uint32_t& variance = state_.variance[axis];
  const int16_t innovation = limit_i16(z_mm - asr(place, 13), INT16_MAX);
  // Variances in 32 mm^2, this one below 2^14.
  const auto half = static_cast<uint16_t>(static_cast<uint16_t>(variance >> 16) >> 1);
  const auto sum =
      static_cast<uint16_t>(half + static_cast<uint16_t>(asr(mul_i16(sigma_mm, sigma_mm), 5)));
  if (gate != 0 &&
      static_cast<uint32_t>(asr(mul_i16(innovation, innovation), 5)) > mul_u16(sum, gate)) {
    variance += kDoubt;  // the next tick's growth limits it
    return false;
  }
  // Below 1: sigma_mm is at least 8.
  const uint16_t gain_q15 = quotient_u16(mul_u16(half, 1U << 15), sum);
  place += asr(mul_i16(innovation, static_cast<int16_t>(gain_q15)), 2);
  variance -= mul_u16(static_cast<uint16_t>(half << 2), gain_q15);
  return true;
}

void PositionEstimate::get(Place& place) const {
  for (uint8_t axis = 0; axis < 2; ++axis) {
    place.mm[axis] = limit_i16(asr(state_.place[axis], 13), INT16_MAX);
    place.sigma[axis] = static_cast<uint8_t>(isqrt32(state_.variance[axis]) >> 8);
  }
}

// The walls of the site.

bool touch_wall(const BoardConstants& board, const Parameters& parameters, Angle travel, bool felt,
                PositionEstimate& position) {
  // Quarters of a turn, their middles east, north, west and south.
  const auto quarter = static_cast<uint8_t>(static_cast<uint16_t>(travel + 8192) >> 14);
  const uint8_t axis = quarter & 1U;
  const int16_t half = (&parameters.values[Parameters::k_site_x])[axis];
  if (half == 0) return false;
  auto place = static_cast<int16_t>(half - static_cast<int16_t>(board.hull_reach_mm));
  if (quarter >= 2) place = static_cast<int16_t>(-place);
  const bool west_of_it = static_cast<int16_t>(position.mm(axis)) < place;
  if (!felt && west_of_it == (quarter < 2)) return false;
  return position.measure(axis, place, kWallSigma_mm, 9);
}

}  // namespace screed
