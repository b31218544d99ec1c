// The rules as published.
#include "nn/training/parameter_update.h"

#include <algorithm>
#include <cmath>

namespace screed::nn {
namespace {

constexpr float kRpropFirstStep = 0.1F;
constexpr float kRpropMaxStep = 50.0F;
constexpr float kRpropGrowth = 1.2F;
constexpr float kRpropShrinkage = 0.5F;

constexpr double kAdamMean = 0.9;
constexpr double kAdamSquare = 0.999;
constexpr double kAdamEpsilon = 1e-8;

void irprop(std::span<const float> gradient, float l2, std::span<float> parameters,
            UpdateState& state) {
  if (state.first.empty()) {
    state.first.assign(parameters.size(), kRpropFirstStep);
    state.second.assign(parameters.size(), 0.0F);
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    float slope = gradient[i] + 2.0F * l2 * parameters[i];
    const float agreement = slope * state.second[i];
    if (agreement > 0.0F) {
      state.first[i] = std::min(state.first[i] * kRpropGrowth, kRpropMaxStep);
    } else if (agreement < 0.0F) {
      state.first[i] *= kRpropShrinkage;
      slope = 0.0F;
    }
    if (slope > 0.0F) parameters[i] -= state.first[i];
    if (slope < 0.0F) parameters[i] += state.first[i];
    state.second[i] = slope;
  }
}

void sgd(float rate, std::span<const float> gradient, float l2, std::span<float> parameters) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    parameters[i] -= rate * (gradient[i] + 2.0F * l2 * parameters[i]);
  }
}

void adam(double rate, std::span<const float> gradient, double l2, std::span<float> parameters,
          UpdateState& state) {
  if (state.first.empty()) {
    state.first.assign(parameters.size(), 0.0F);
    state.second.assign(parameters.size(), 0.0F);
  }
  const auto steps = static_cast<double>(state.steps + 1);
  const double mean_share = 1.0 - std::pow(kAdamMean, steps);
  const double square_share = 1.0 - std::pow(kAdamSquare, steps);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const double slope =
        static_cast<double>(gradient[i]) + 2.0 * l2 * static_cast<double>(parameters[i]);
    const double mean = kAdamMean * static_cast<double>(state.first[i]) + (1.0 - kAdamMean) * slope;
    const double square =
        kAdamSquare * static_cast<double>(state.second[i]) + (1.0 - kAdamSquare) * slope * slope;
    state.first[i] = static_cast<float>(mean);
    state.second[i] = static_cast<float>(square);
    parameters[i] -= static_cast<float>(rate * (mean / mean_share) /
                                        (std::sqrt(square / square_share) + kAdamEpsilon));
  }
}

}  // namespace

void update_parameters(OptimiserKind optimiser, double learning_rate, double l2,
                       std::span<const float> gradient, std::span<float> parameters,
                       UpdateState& state) {
  switch (optimiser) {
    case OptimiserKind::kIrprop:
      irprop(gradient, static_cast<float>(l2), parameters, state);
      break;
    case OptimiserKind::kSgd:
      sgd(static_cast<float>(learning_rate), gradient, static_cast<float>(l2), parameters);
      break;
    case OptimiserKind::kAdam:
      adam(learning_rate, gradient, l2, parameters, state);
      break;
  }
  ++state.steps;
}

}  // namespace screed::nn
