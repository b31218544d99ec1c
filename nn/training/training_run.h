// A whole training: every network of a configuration in a thread of its own, with checkpoints.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "nn/model/model_file.h"
#include "nn/training/prepared_data.h"

namespace screed::nn {

struct TrainedNetwork {
  std::vector<FloatLayer> layers;  ///< of the epoch that is kept
  std::size_t kept_epoch = 0;      ///< counts from 1
  /// An epoch each: mean squared errors, the choice's on its session as trained.
  std::vector<EpochLoss> losses;
};

struct TrainingOptions {
  /// Where checkpoints lie, a file a network; they are written every fiftieth part of the epochs.
  std::optional<std::filesystem::path> checkpoints;
  bool resume = false;  ///< go on from the checkpoints where there are some
  /// Told after every epoch, from any thread but never from two at once: the share of all epochs
  /// that is done, and what is new.
  std::function<void(double share, const std::string& note)> progress;
  /// Ends the training in the midst of an epoch; the checkpoints are then those of its beginning.
  const std::atomic<bool>* stop = nullptr;
};

/// In the order of the configuration's networks. The same configuration, seed and data give the
/// same bits, whatever the threads do, and whether or not it was resumed on the way. Throws
/// InputError for a checkpoint of another training, TaskStopped when it was stopped.
std::vector<TrainedNetwork> train(const TrainingConfiguration& configuration,
                                  const PreparedData& data, const TrainingOptions& options);

/// Quantised, with names, scales, stages and golden vectors.
Model make_model(const TrainingConfiguration& configuration, const PreparedData& data,
                 const std::vector<TrainedNetwork>& networks);

}  // namespace screed::nn
