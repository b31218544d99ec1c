// The state of a network's training as a file.
#pragma once

#include <filesystem>
#include <string>

#include "nn/training/training_run.h"

namespace screed::nn {

struct Checkpoint {
  std::string training;  ///< hash over configuration, seed and data: what it belongs to
  TrainerState state;
  TrainedNetwork result;  ///< so far
};

/// The file appears complete or not at all. Throws RunError when it cannot be written.
void write_checkpoint(const std::filesystem::path& file, const Checkpoint& checkpoint);
/// Throws InputError, one line with file and place, when it is none.
Checkpoint read_checkpoint(const std::filesystem::path& file);

}  // namespace screed::nn
