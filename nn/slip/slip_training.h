// Trains the network of the robot's slip watch on drives.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
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

/// The model "slip": output held, half the log of the odds that the chassis makes less than three
/// tenths of the tracks' travel (over 0.3 s around that moment), from the watch's inputs as they
/// are on the robot.
Model train_slip(const std::vector<SlipRun>& runs, const SlipTrainingOptions& options);

}  // namespace screed::nn
