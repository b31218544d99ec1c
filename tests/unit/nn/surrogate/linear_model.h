// Networks whose answers are known in closed form.
#pragma once

#include <utility>
#include <vector>

#include "nn/model/model_file.h"

namespace screed::nn {

inline ModelChannel channel(const char* feature, double half_range, const char* baseline = "") {
  return {feature, 0.0, half_range, baseline};
}

/// y = W x + b.
inline Model linear_model(std::vector<ModelChannel> inputs, std::vector<ModelChannel> outputs,
                          std::vector<double> weights, std::vector<double> bias) {
  const std::vector<FloatLayer> layers = {
      {inputs.size(), outputs.size(), true, std::move(weights), std::move(bias)}};
  Model model;
  model.name = "linear";
  model.networks.push_back({std::move(inputs), std::move(outputs), quantise(layers), layers, {}});
  return model;
}

}  // namespace screed::nn
