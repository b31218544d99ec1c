// The patient agent and the forager.
#include "host_sim/grid/agents/foraging_agent.h"

#include "firmware/math/fixed.h"

namespace screed {
namespace {

constexpr uint8_t kDownhillTurnFactor = 8;  // times as many turns while the height gets worse

constexpr int32_t to_q16(uint16_t height) {
  return static_cast<int32_t>(height) << 16;  // fits: heights end at kMaxStackHeight
}

}  // namespace

ForagingAgent::ForagingAgent(const ForagingParameters& parameters, uint32_t seed, uint32_t stream)
    : random_(seed, stream), parameters_(parameters) {
  const int32_t dead_band_q16 = static_cast<int32_t>(parameters.dead_band_q8) << 8;
  patience_slope_q16_ = parameters.patience == 0 ? 0 : dead_band_q16 / parameters.patience;
  direction_ = static_cast<uint8_t>(random_.next() >> 29);
}

void ForagingAgent::sense(int32_t height_q16) {
  // The mean of all samples at first, an exponential average later.
  if (samples_ < parameters_.averaging) ++samples_;
  average_q16_ += (height_q16 - average_q16_) / static_cast<int32_t>(samples_);
}

/// How far from the average a cell must be now.
int32_t ForagingAgent::claim_q16() const {
  const int32_t waited = waited_;
  int32_t claim = static_cast<int32_t>(parameters_.dead_band_q8) << 8;
  const int32_t patience = parameters_.patience;
  if (patience != 0 && waited > patience) {
    claim = waited < 2 * patience ? patience_slope_q16_ * (2 * patience - waited) : 0;
  }
  const int32_t hold_out = parameters_.hold_out;
  if (waited < hold_out) claim += hold_out_slope_q16_[carries_ ? 1 : 0] * (hold_out - waited);
  return claim;
}

GridOperation ForagingAgent::operate(uint16_t height) {
  if (waited_ != UINT16_MAX) ++waited_;
  if (samples_ < kMinSamples && samples_ < parameters_.averaging) return GridOperation::kNone;
  const int32_t above_q16 = to_q16(height) - average_q16_;
  const int32_t distance_q16 = carries_ ? -above_q16 : above_q16;
  if (distance_q16 <= claim_q16()) return GridOperation::kNone;

  const int32_t beyond_q16 = distance_q16 - (static_cast<int32_t>(parameters_.dead_band_q8) << 8);
  if (parameters_.hold_out != 0) {
    hold_out_slope_q16_[carries_ ? 1 : 0] =
        beyond_q16 > 0 ? beyond_q16 / static_cast<int32_t>(parameters_.hold_out) : 0;
  }
  waited_ = 0;
  carries_ = !carries_;
  return carries_ ? GridOperation::kPickUp : GridOperation::kDeposit;
}

Probability ForagingAgent::turn_probability(uint16_t height) const {
  if (!parameters_.follows_slope || height == last_height_) return parameters_.turn;
  const bool better = carries_ ? height < last_height_ : height > last_height_;
  return better ? 0 : parameters_.turn * kDownhillTurnFactor;
}

uint8_t ForagingAgent::step(const GridInput& input, GridOperation operation) {
  if (parameters_.turns_back && operation != GridOperation::kNone) {
    return static_cast<uint8_t>((direction_ + 4U) & 7U);
  }
  const uint32_t draw = random_.next();  // 16 bits for the choice, 3 for the direction
  if (!input.arrived || bernoulli(draw & 0xFFFFU, turn_probability(input.height))) {
    return static_cast<uint8_t>(draw >> 29);
  }
  return direction_;
}

GridAction ForagingAgent::tick(const GridInput& input) {
  if (input.arrived && bernoulli(random_.next() & 0xFFFFU, parameters_.sense)) {
    sense(to_q16(input.height));
  }
  const GridOperation operation = operate(input.height);
  direction_ = step(input, operation);
  last_height_ = input.height;
  return {operation, direction_};
}

}  // namespace screed
