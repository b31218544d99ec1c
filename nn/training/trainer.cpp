// The loop over epochs, and the optimisers' rules as published.
#include "nn/training/trainer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace screed::nn {
namespace {

constexpr std::size_t kCheckpoints = 50;

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

void run_training(Trainer& trainer, const TrainingPlan& plan, std::vector<EpochLoss>& losses) {
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;  // epoch, counting from 1
  const auto compare = [&](std::size_t epoch) {
    const bool better = losses[epoch - 1].choice < least;
    if (better) {
      least = losses[epoch - 1].choice;
      best = epoch;
    }
    return better;
  };
  for (std::size_t epoch = 1; epoch <= losses.size(); ++epoch) compare(epoch);
  const auto done = [&] {
    return losses.size() >= plan.epochs ||
           (plan.patience > 0 && losses.size() - best >= plan.patience);
  };
  const std::size_t interval = std::max<std::size_t>(1, plan.epochs / kCheckpoints);
  while (!done()) {
    const bool stopped = plan.stop && plan.stop();
    const auto loss = stopped ? std::nullopt : trainer.train_epoch(losses.size(), plan.stop);
    if (!loss.has_value()) {
      trainer.checkpoint();
      return;
    }
    losses.push_back(*loss);
    const std::size_t epochs = losses.size();
    if (compare(epochs) || !plan.keep_best) trainer.keep();
    if (epochs % interval == 0 || done()) trainer.checkpoint();
    if (plan.progress) {
      plan.progress(losses,
                    done() ? 1.0 : static_cast<double>(epochs) / static_cast<double>(plan.epochs));
    }
  }
}

void run_epochs(Trainer& trainer, std::size_t epochs, const EpochProgress& progress) {
  std::vector<EpochLoss> losses;
  TrainingPlan plan{.epochs = epochs};
  if (progress) {
    plan.progress = [&](const std::vector<EpochLoss>& so_far, double /*share*/) {
      progress(so_far.size(), so_far.back().training);
    };
  }
  run_training(trainer, plan, losses);
}

std::vector<std::uint32_t> shuffled(std::size_t count, WorldRandom random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  for (std::size_t i = count; i > 1; --i) {
    // 32 random bits for some 10^5 examples: the bias is below 10^-4 and the same everywhere.
    std::swap(order[i - 1], order[(std::uint64_t{random.next()} * i) >> 32U]);
  }
  return order;
}

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
