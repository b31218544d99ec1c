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
  std::size_t hidden = 8;
  std::size_t epochs = 60;
  std::function<void(std::size_t epoch, double error)> progress;  ///< may be empty
};

/// The model "slip": output speed_share, the chassis' speed as a share of the faster track's, from
/// the watch's inputs as they are on the robot. Ticks at which the robot hardly moves count more.
Model train_slip(const std::vector<SlipRun>& runs, const SlipTrainingOptions& options);

}  // namespace screed::nn
