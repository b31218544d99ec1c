// Which moments of drives the slip watch learns from, and what it is told of them.
#pragma once

#include <vector>

#include "nn/slip/stuck_run.h"
#include "nn/training/network_trainer.h"

namespace screed::nn {

/// Every fourth tick of a running robot in which its slip watch evaluates: the watch's inputs, as
/// values of Q15, and 1 where the chassis makes less than 0.3 of the tracks' travel in the 15 ticks
/// before and after, else 0. Ticks in between, from 0.25 to 0.4, teach nothing.
Examples slip_examples(const std::vector<SlipRun>& runs);

}  // namespace screed::nn
