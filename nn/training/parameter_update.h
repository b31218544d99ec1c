// How parameters follow their gradients: the optimisers, on plain numbers.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "nn/training/configuration.h"

namespace screed::nn {

/// What an optimiser remembers of one array of parameters. Part of a checkpoint.
struct UpdateState {
  std::vector<float> first;   ///< iRPROP-: step sizes. Adam: mean of the gradient
  std::vector<float> second;  ///< iRPROP-: gradients before. Adam: mean of its square
  std::size_t steps = 0;
};

/// One step. l2 is for weights; give 0 for biases. The gradient is that of the loss alone.
///
/// iRPROP- (Igel and Huesken, 2000): steps of 0.1 at first, x1.2 while the sign of the gradient
/// stays, x0.5 when it changes, 0 to 50, as FANN has it; it knows no learning rate.
/// Adam (Kingma and Ba, 2015): 0.9, 0.999, 1e-8.
void update_parameters(OptimiserKind optimiser, double learning_rate, double l2,
                       std::span<const float> gradient, std::span<float> parameters,
                       UpdateState& state);

}  // namespace screed::nn
