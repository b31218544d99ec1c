// Algorithm 1 with the move_agent() of Algorithm 2.
#include "host_sim/grid/agents/probabilistic_agent.h"

#include "host_sim/grid/agents/response_curve.h"

namespace screed {
ProbabilisticAgent::ProbabilisticAgent(const ProbabilisticParameters& parameters, uint32_t seed,
                                       uint32_t stream)
    : random_(seed, stream), memory_(parameters.memory_length), parameters_(parameters) {
  direction_ = static_cast<uint8_t>(random_.next() >> 29);
}

Probability ProbabilisticAgent::probability(uint16_t height) const {
  const uint16_t k_q8 = parameters_.threshold_q8;
  if (k_q8 == 0) return carries_ ? parameters_.deposit : parameters_.pick_up;
  return carries_ ? response_deposit(height, k_q8) : response_pick_up(height, k_q8);
}

GridAction ProbabilisticAgent::tick(const GridInput& input) {
  const uint16_t height = input.height;
  const uint32_t chances = random_.next();  // 16 bits for sensing, 16 for the operation
  if (input.arrived && bernoulli(chances & 0xFFFFU, parameters_.sense)) memory_.add(height);

  // Chance and condition are joined without branches: half of them would be guessed wrong.
  const bool wants = carries_ ? memory_.is_below(height) : memory_.is_above(height);
  GridOperation operation = GridOperation::kNone;
  if (static_cast<unsigned>(wants) &
      static_cast<unsigned>(bernoulli(chances >> 16, probability(height)))) {
    carries_ = !carries_;
    operation = carries_ ? GridOperation::kPickUp : GridOperation::kDeposit;
  }

  const uint32_t step = random_.next();  // 16 bits for the choice, 3 for the direction
  const uint8_t turns = bernoulli(step & 0xFFFFU, parameters_.turn) ? 0xFFU : 0U;
  direction_ = static_cast<uint8_t>(direction_ ^ ((direction_ ^ (step >> 29)) & turns));
  return {operation, direction_};
}

}  // namespace screed
