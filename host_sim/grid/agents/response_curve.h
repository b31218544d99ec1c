// The response-threshold curves of thesis 4.2.1 (Deneubourg et al.): the higher a stack, the
// likelier it is picked from, and the less likely put on.
#pragma once

#include <stdint.h>

#include "host_sim/grid/agents/grid_types.h"

namespace screed {

/// (h / (k + h))^2, k = k_q8 / 256 > 0. Right within 3 * 2^-16 for heights below
/// 256, within 2^-7 for all.
Probability response_pick_up(uint16_t height, uint16_t k_q8);

/// (k / (k + h))^2, likewise.
Probability response_deposit(uint16_t height, uint16_t k_q8);

}  // namespace screed
