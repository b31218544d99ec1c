// Trains the slip watch's network on sequences of steps, back through time.
//
// Loss of a step: held_weight (cross entropy of output 0 as the log of the odds with held)
//   + kShareLoss share_weight / 0.15 m/s (output 1 - share)^2.
// Adam (Kingma and Ba, 2015) over windows of kWindow steps of kLanes drives at once; the states go
// on from window to window, the gradient does not. From 40 % of the epochs on the forward pass has
// weights rounded to 8 bits, the gradient is taken as if it had not (straight through).
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "nn/slip/gated_network.h"
#include "nn/slip/slip_sequence.h"

namespace screed::nn {

struct GatedTrainingOptions {
  std::uint64_t seed = 1;
  std::uint8_t units = kSlipUnits;
  std::size_t epochs = 150;
  double learning_rate = 0.01;
  double final_rate = 0.02;    ///< share of it in the last epoch; geometric between
  double held_emphasis = 1.0;  ///< weight of a step that is held, where a free one has 1
  std::function<void(std::size_t epoch, double loss)> progress;  ///< may be empty
};

/// The same sequences, options and build give the same network. Throws RunError without steps.
GatedNetwork train_gated(const std::vector<std::vector<SlipStep>>& sequences,
                         const GatedTrainingOptions& options);

/// Loss and its gradient over one window of sequences of equal length, states zero at the start;
/// for tests.
struct GatedGradient {
  double loss;
  GatedNetwork gradient;
};
GatedGradient gated_gradient(const GatedNetwork& network,
                             const std::vector<std::vector<SlipStep>>& lanes);

}  // namespace screed::nn
