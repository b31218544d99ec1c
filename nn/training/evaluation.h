// How good a model is on test sessions, as numbers and as charts.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "nn/training/prepared_data.h"
#include "nn/training/training_run.h"

namespace screed::nn {

/// One output on one test. Errors are of normalised numbers, as in the thesis.
struct Score {
  std::string output;
  std::string test;  ///< label of the session
  std::string form;  ///< "as trained", "smoothed", "raw"
  std::size_t frames = 0;
  double mse = 0.0;
  double r2 = 0.0;            ///< squared correlation, as the thesis has it
  double explained = 0.0;     ///< 1 - error / variance
  double quantisation = 0.0;  ///< greatest difference between integers and floating point
};

/// Two features whose ranks are compared (thesis Table 6.2).
struct RankScore {
  std::string pair;
  std::string test;
  std::string form;
  double recorded = 0.0;
  double predicted = 0.0;
};

struct Evaluation {
  std::vector<Score> scores;
  std::vector<RankScore> ranks;
};

/// By the integers of the robot.
Evaluation evaluate(const Model& model, const std::vector<TestTable>& tests,
                    const TaskProgress& progress = {});

/// Time series and regression of every output on every test, as SVG and PNG; returns the SVG files.
/// The folder must exist. Throws RunError when a file cannot be written.
std::vector<std::filesystem::path> draw_evaluation(const Model& model,
                                                   const std::vector<TestTable>& tests,
                                                   const std::filesystem::path& folder,
                                                   const TaskProgress& progress = {});

/// Losses over the epochs, an SVG and a PNG a network.
std::vector<std::filesystem::path> draw_losses(const TrainingConfiguration& configuration,
                                               const std::vector<TrainedNetwork>& networks,
                                               const std::filesystem::path& folder);

}  // namespace screed::nn
