// The data of a training: sessions read, pre-processed, and cut into examples for a network.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nn/data/preprocessing.h"
#include "nn/model/model_file.h"
#include "nn/training/configuration.h"
#include "nn/training/network_trainer.h"

namespace screed::nn {

/// A test session in one of the forms in which it is compared.
struct TestTable {
  std::string label;  ///< of the session
  std::string form;   ///< "as trained", "smoothed" or "raw"
  FeatureTable table;
};

struct PreparedData {
  Preprocessing preprocessing{{}};
  std::vector<FeatureTable> training;
  /// The training sessions as a running world shows them to the network: not rounded, where
  /// rounding is no stage of run time. Integers are chosen for these.
  std::vector<FeatureTable> running;
  FeatureTable choice;  ///< as trained
  std::vector<TestTable> tests;
  std::size_t training_frames = 0;  ///< before outliers went
  std::string hash;                 ///< over the training examples
};

/// Reads the sessions of the configuration from a folder (nn/data/features.h). Statistics come
/// from the training sessions alone. Throws InputError.
PreparedData prepare(const TrainingConfiguration& configuration,
                     const std::filesystem::path& sessions, const TaskProgress& progress = {});

/// The tests alone, by the stages and scales that a model carries.
std::vector<TestTable> prepare_tests(const TrainingConfiguration& configuration, const Model& model,
                                     const std::filesystem::path& sessions,
                                     const TaskProgress& progress = {});

/// All rows of these tables, one table after the other, for one network.
Examples examples_of(const std::vector<const FeatureTable*>& tables,
                     const std::vector<std::string>& inputs,
                     const std::vector<std::string>& outputs);

/// The features that the network's outputs are compared with.
std::vector<std::string> learned_outputs(const NetworkConfiguration& network);

}  // namespace screed::nn
