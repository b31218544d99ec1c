// A network of motion while it learns, by tiny-dnn: it is driven along sequences of recorded
// sessions on its own predictions, and every frame's error reaches back through all frames before
// it (backpropagation through time). So it is trained for a distance, not for a frame.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "nn/model/model_file.h"
#include "nn/surrogate/motion_series.h"

namespace screed::nn {

struct MotionTraining {
  std::vector<ModelChannel> inputs;  ///< names of nn/data/motion_signals.h
  /// forward, sideways, delta_theta, each with a baseline: itself a frame ago (NAME@1), or what it
  /// would settle to (NAME_settling, nn/surrogate/surrogate.h).
  std::vector<ModelChannel> outputs;
  std::vector<std::size_t> hidden = {20, 20};  ///< nodes a hidden layer, tanh
  std::size_t window = 60;                     ///< frames of a sequence
  std::size_t batch = 64;                      ///< sequences at a time
  std::size_t steps = 2500;
  double learning_rate = 0.003;  ///< Adam's at its highest; rises for a tenth of the steps, falls
  double frame_weight = 1.0;     ///< of the errors of frames
  double mean_weight = 1.0;      ///< of the error of a sequence's mean motion
  double mean_knee = 0.02;       ///< of that error, from where on it does not count by its square
  bool mirror = false;           ///< half of the sequences are driven with left and right exchanged
  std::uint64_t seed = 1;
};

class MotionTrainer {
 public:
  /// Throws InputError when a channel is not known.
  explicit MotionTrainer(const MotionTraining& training);
  ~MotionTrainer();

  /// One step over a batch of sequences drawn from the series; returns the mean loss of the batch.
  double step(const std::vector<MotionSeries>& series);
  std::size_t steps() const;
  std::vector<FloatLayer> layers() const;

  /// Loss over the first sequence of every series, and its gradient by every parameter, a layer's
  /// weights (an input's row after the other), then its biases. For tests.
  double loss(const std::vector<MotionSeries>& series);
  std::vector<std::vector<float>> gradient(const std::vector<MotionSeries>& series);
  /// Adds to one parameter, in the order of gradient(). For tests.
  void nudge(std::size_t array, std::size_t index, float by);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace screed::nn
