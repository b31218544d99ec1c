// The response-threshold curves in fixed point.
#include "host_sim/grid/agents/response_curve.h"

namespace screed {
namespace {

/// a / b as Q16 for a <= b, squared.
Probability squared_ratio(uint32_t a_q8, uint32_t b_q8) {
  // Heights of 256 and more, whose Q8 value leaves no room for 16 more digits, lose eight of them.
  while (a_q8 > 0xFFFFU) {
    a_q8 >>= 8;
    b_q8 >>= 8;
  }
  const uint32_t ratio = (a_q8 << 16) / b_q8;
  if (ratio >= kAlways) return kAlways;
  return (ratio * ratio) >> 16;
}

}  // namespace

Probability response_pick_up(uint16_t height, uint16_t k_q8) {
  const uint32_t height_q8 = static_cast<uint32_t>(height) << 8;
  return squared_ratio(height_q8, height_q8 + k_q8);
}

Probability response_deposit(uint16_t height, uint16_t k_q8) {
  const uint32_t height_q8 = static_cast<uint32_t>(height) << 8;
  return squared_ratio(k_q8, height_q8 + k_q8);
}

}  // namespace screed
