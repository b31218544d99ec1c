// Trains the network of the robot's slip watch on drives.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "nn/model/model_file.h"
#include "nn/slip/stuck_run.h"

namespace screed::nn {

struct SlipTrainingOptions {
  std::uint64_t seed = 1;
  std::size_t hidden = 16;
  std::size_t epochs = 12;
  std::function<void(std::size_t epoch, double error)> progress;  ///< may be empty
};

/// Mean cross entropy of outputs (log of the odds) with what was wanted (0 or 1), nats an example;
/// ln 2 for a guess.
double mean_cross_entropy(std::span<const float> logits, std::span<const float> wanted);

/// The model "slip": output held, half the log of the odds that the robot hardly moves
/// (slip_examples.h), from the watch's inputs as they are on the robot. Throws RunError with fewer
/// than 1000 examples.
Model train_slip(const std::vector<SlipRun>& runs, const SlipTrainingOptions& options);

}  // namespace screed::nn
