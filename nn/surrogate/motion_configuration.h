// The training of a network of motion as a file says it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nn/surrogate/motion_trainer.h"

namespace screed::nn {

struct MotionConfiguration {
  std::string name;
  std::string about;
  std::vector<std::string> train;  ///< names of sessions
  std::vector<std::string> test;
  MotionTraining training;
};

/// Throws InputError, one line with file, place and what is allowed.
MotionConfiguration read_motion_configuration(const std::filesystem::path& file);

/// The session of that name in a folder of sessions, read. Throws InputError.
std::vector<MotionSeries> read_motion_sessions(const std::filesystem::path& folder,
                                               const std::vector<std::string>& names);

/// What the trainer has now, as a model that the surrogate world runs.
Model motion_model(const MotionConfiguration& configuration, const MotionTrainer& trainer,
                   const std::vector<MotionSeries>& series);

/// How well a network predicts one frame from the recorded frames before it: 1 - sum of squared
/// errors / sum of squared differences from the mean, of forward, sideways and turn.
std::array<double, 3> one_frame_r2(const Model& model, const MotionSeries& series);
/// The same of the prediction that nothing changes.
std::array<double, 3> unchanged_r2(const MotionSeries& series);

}  // namespace screed::nn
