// One network while it learns, by tiny-dnn. The only header of it; tiny-dnn itself is known to
// network_trainer.cpp alone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "nn/model/quantiser.h"
#include "nn/training/configuration.h"
#include "nn/training/trainer.h"

namespace screed::nn {

/// Inputs and wanted outputs, a row an example, one after the other.
struct Examples {
  std::size_t inputs = 0;
  std::size_t outputs = 0;
  std::vector<float> in;
  std::vector<float> out;

  std::size_t rows() const { return inputs == 0 ? 0 : in.size() / inputs; }
};

/// All that goes on changing while a network learns.
struct TrainerState {
  std::size_t epochs = 0;                      ///< done
  std::vector<std::vector<float>> parameters;  ///< weights, biases, scales, means and variances
  std::vector<UpdateState> updates;
};

class NetworkTrainer {
 public:
  virtual ~NetworkTrainer() = default;

  /// Goes once through the examples, in an order that follows from seed and epoch. Where `stop`,
  /// asked on the way, says so, the state becomes that before the epoch again; false then.
  virtual bool train_epoch(const Examples& examples, const std::function<bool()>& stop) = 0;

  /// What it would give now, as layers of the quantiser: batch normalisation (by its running means)
  /// and steepness are folded into weights and biases.
  virtual std::vector<FloatLayer> folded() const = 0;
  /// tiny-dnn's own outputs for the examples, as it stands when not learning.
  virtual std::vector<float> outputs(const Examples& examples) = 0;
  /// Gradient of the mean loss over the examples as one batch, an array a parameter array
  /// in the order of state(); nothing is changed. For tests.
  virtual std::vector<std::vector<float>> gradient(const Examples& examples) = 0;

  virtual TrainerState state() const = 0;
  /// Goes on from a state of the same configuration. Throws InputError when it does not fit.
  virtual void restore(const TrainerState& state) = 0;
};

/// The same seed gives the same network and the same course.
std::unique_ptr<NetworkTrainer> make_network_trainer(const NetworkConfiguration& configuration,
                                                     std::uint64_t seed);

}  // namespace screed::nn
