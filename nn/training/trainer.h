// What all trainers share: the loop over epochs with early stopping and checkpoints, the order of
// examples, and how parameters follow their gradients.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/core/random.h"

namespace screed::nn {

/// Mean losses of an epoch.
struct EpochLoss {
  double training = 0.0;
  double choice = 0.0;  ///< by which epochs are compared; where no data are kept for it, `training`
};

/// A network while it learns. What an epoch makes of it follows from examples and seed alone.
class Trainer {
 public:
  virtual ~Trainer() = default;

  /// Goes once through the examples; epochs count from 0. Nothing where `stop`, asked on the way,
  /// says so: all is then as it was before the epoch. A trainer may leave it unasked.
  virtual std::optional<EpochLoss> train_epoch(std::size_t epoch,
                                               const std::function<bool()>& stop) = 0;
  /// The network as it is now is the result so far.
  virtual void keep() {}
  /// Writes down all that is needed to go on from here.
  virtual void checkpoint() {}
};

struct TrainingPlan {
  std::size_t epochs = 1;
  /// Epochs without a better loss of the choice after which it stops; 0: never.
  std::size_t patience = 0;
  bool keep_best = false;  ///< the epoch with the least loss of the choice, not the last one
  std::function<bool()> stop = {};  ///< ends the training in the midst of an epoch; may be empty
  /// Told after every epoch: the losses so far, and the share of the training that is done; may be
  /// empty.
  std::function<void(const std::vector<EpochLoss>& losses, double share)> progress = {};
};

/// Goes on behind the epochs of `losses` until the plan is fulfilled or it is stopped. A checkpoint
/// is asked for every fiftieth part of the epochs, at the end, and when it is stopped.
void run_training(Trainer& trainer, const TrainingPlan& plan, std::vector<EpochLoss>& losses);

/// Progress of trainings without data for a choice: the epoch, counting from 1, and its loss.
using EpochProgress = std::function<void(std::size_t epoch, double loss)>;
/// So many epochs, to the end.
void run_epochs(Trainer& trainer, std::size_t epochs, const EpochProgress& progress);

/// 0 to `count` - 1 in a random order.
std::vector<std::uint32_t> shuffled(std::size_t count, WorldRandom random);

enum class OptimiserKind : std::uint8_t { kIrprop, kSgd, kAdam };

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
