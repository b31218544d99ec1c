// Inputs brought to mean 0 and deviation 1 for learning, and the first layer brought back.
#pragma once

#include <vector>

#include "nn/model/quantiser.h"
#include "nn/training/network_trainer.h"

namespace screed::nn {

class InputStatistics {
 public:
  /// Mean and standard deviation (of the population, at least 1e-6) of each input.
  explicit InputStatistics(const Examples& examples);

  const std::vector<double>& mean() const { return mean_; }
  const std::vector<double>& deviation() const { return deviation_; }
  /// The same examples with every input of mean 0 and deviation 1.
  Examples standardised(Examples examples) const;
  /// Makes a layer that learned on standardised inputs give the same of the inputs as they are.
  void fold_into(FloatLayer& first) const;

 private:
  std::vector<double> mean_;
  std::vector<double> deviation_;
};

}  // namespace screed::nn
