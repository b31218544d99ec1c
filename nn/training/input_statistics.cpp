// Two passes over a table.
#include "nn/training/input_statistics.h"

#include <algorithm>
#include <cmath>

namespace screed::nn {

InputStatistics::InputStatistics(const Examples& examples) {
  const auto rows = static_cast<double>(examples.rows());
  for (std::size_t i = 0; i < examples.inputs; ++i) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t at = i; at < examples.in.size(); at += examples.inputs) {
      const auto value = static_cast<double>(examples.in[at]);
      sum += value;
      squares += value * value;
    }
    const double mean = sum / rows;
    mean_.push_back(mean);
    deviation_.push_back(std::sqrt(std::max(squares / rows - mean * mean, 1e-12)));
  }
}

Examples InputStatistics::standardised(Examples examples) const {
  for (std::size_t at = 0; at < examples.in.size(); ++at) {
    const std::size_t i = at % examples.inputs;
    examples.in[at] =
        static_cast<float>((static_cast<double>(examples.in[at]) - mean_[i]) / deviation_[i]);
  }
  return examples;
}

void InputStatistics::fold_into(FloatLayer& first) const {
  for (std::size_t node = 0; node < first.outputs; ++node) {
    for (std::size_t i = 0; i < first.inputs; ++i) {
      double& weight = first.weights[node * first.inputs + i];
      weight /= deviation_[i];
      first.bias[node] -= weight * mean_[i];
    }
  }
}

}  // namespace screed::nn
