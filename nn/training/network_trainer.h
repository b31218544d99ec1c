// One network while it learns, by tiny-dnn. The only header of it; tiny-dnn itself is known to
// network_trainer.cpp alone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "nn/model/quantiser.h"
#include "nn/training/configuration.h"
#include "nn/training/parameter_update.h"

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
  /// The same seed gives the same network and the same course.
  NetworkTrainer(const NetworkConfiguration& configuration, std::uint64_t seed);
  NetworkTrainer(NetworkTrainer&&) noexcept;
  NetworkTrainer& operator=(NetworkTrainer&&) noexcept;
  ~NetworkTrainer();

  /// Goes once through the examples, in an order that follows from seed and epoch. Where `stop`,
  /// asked on the way, says so, the state becomes that before the epoch again; false then.
  bool train_epoch(const Examples& examples, const std::function<bool()>& stop = {});
  std::size_t epochs() const;

  /// What it would give now, as layers of the quantiser: batch normalisation (by its running means)
  /// and steepness are folded into weights and biases.
  std::vector<FloatLayer> folded() const;
  /// tiny-dnn's own outputs for the examples, as it stands when not learning.
  std::vector<float> outputs(const Examples& examples);
  /// Gradient of the mean loss over the examples as one batch, an array a parameter array
  /// in the order of state(); nothing is changed. For tests.
  std::vector<std::vector<float>> gradient(const Examples& examples);

  TrainerState state() const;
  /// Goes on from a state of the same configuration. Throws InputError when it does not fit.
  void restore(const TrainerState& state);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace screed::nn
