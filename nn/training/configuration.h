// A training as a file says it: which sessions, which pre-processing, which networks and how they
// learn.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "nn/data/preprocessing.h"
#include "nn/training/trainer.h"

namespace screed::nn {

enum class Initialisation : std::uint8_t {
  kNormalised,  ///< uniform within sqrt(6 / (inputs + outputs)) (thesis 6.2.1)
  kUniform,     ///< uniform within initial_range (thesis 6.3.1)
};

enum class BatchNormalisation : std::uint8_t {
  kNone,
  kPlain,   ///< mean 0, variance 1 between weights and activation, as tiny-dnn has it
  kScaled,  ///< and a scale and an offset a node that are learned, as Keras has it
};

struct NetworkConfiguration {
  std::vector<std::string> inputs;
  std::vector<std::string> outputs;
  std::string baseline;  ///< feature that the (single) output is learned as a difference to, or ""
  std::vector<std::size_t> hidden;  ///< nodes a hidden layer, all with tanh
  /// Hidden nodes are linear and cut at -1 and 1 (a "hard" tanh), which takes no table on the
  /// robot.
  bool limited = false;
  bool linear_output = false;  ///< otherwise tanh
  double steepness = 1.0;      ///< tanh(steepness x)
  Initialisation initialisation = Initialisation::kNormalised;
  double initial_range = 0.05;
  BatchNormalisation batch_normalisation = BatchNormalisation::kNone;
  OptimiserKind optimiser = OptimiserKind::kAdam;
  double learning_rate = 0.001;  ///< not used by iRPROP-
  double final_rate = 1.0;  ///< share of the learning rate in the last epoch; geometric between
  double l2 = 0.0;          ///< l2 x sum of squared weights is added to the loss
  std::size_t batch = 32;   ///< 0: all frames at once
  std::size_t epochs = 25;
  std::size_t patience =
      0;  ///< epochs without a better error of the choice after which it stops; 0: never
  bool keep_best = false;  ///< the epoch with the least error of the choice, not the last one

  std::string name() const;  ///< of its outputs
  /// The feature that the only output is trained on: its difference to the baseline, if any.
  std::string learned_output() const;
};

struct TestSession {
  std::string label;  ///< "A"
  std::string session;
};

/// What the thesis says of an output on a test.
struct ThesisFigure {
  std::string output;
  std::string test;  ///< its label
  double mse = 0.0;
  double r2 = 0.0;
};

struct TrainingConfiguration {
  std::string name;
  std::string about;
  std::uint64_t seed = 1;
  std::vector<std::string> train;  ///< names of sessions
  /// The session by whose error an epoch, a seed or a form is chosen: no test decides anything.
  std::string choice;
  std::vector<TestSession> test;
  std::vector<PreprocessingStage> stages;
  std::vector<NetworkConfiguration> networks;
  std::vector<ThesisFigure> thesis;  ///< to print beside ours
  std::string text;                  ///< of the file

  /// Every feature that any part of it names, once, in a fixed order.
  std::vector<std::string> features() const;
};

/// Throws InputError, one line with file, place and what is allowed.
TrainingConfiguration read_training_configuration(const std::filesystem::path& file);
TrainingConfiguration parse_training_configuration(const std::string& text,
                                                   const std::string& name);

}  // namespace screed::nn
