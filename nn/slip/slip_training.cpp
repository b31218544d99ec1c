// Drives to examples, a network to a model.
#include "nn/slip/slip_training.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "nn/training/network_trainer.h"

namespace screed::nn {
namespace {

// Ranges are those of slip_watch.h; a share of 2 is Q14.
struct Channel {
  const char* name;
  double half_range;
};
constexpr Channel kInputs[] = {
    {"inertial_slip_3s", 2.0}, {"inertial_slip_10s", 2.0},    {"turn", 2.0},
    {"track_difference", 2.0}, {"faster_track", 6.5536},      {"sin_pitch", 2.0},
    {"effort", 2048.0},        {"shaking_pitch_rate", 256.0}, {"shaking_ahead", 256.0},
    {"shaking_up", 256.0},     {"pitch_rate", 512.0}};
static_assert(std::size(kInputs) == kSlipInputs);
// Of the log of the odds that the robot hardly moves: certain enough at either end.
constexpr Channel kOutput = {"held", 2.0};

constexpr std::size_t kDecimation = 4;     // ticks: neighbours say much the same
constexpr std::size_t kMotionWindow = 15;  // ticks before and after, over which motion is taken
constexpr double kHeldShare = 0.3;         // share of motion below which it hardly moves
constexpr double kAmbiguousMin = 0.25;
constexpr double kAmbiguousMax = 0.4;  // what lies between is not learned
constexpr std::size_t kGoldenVectors = 8;

Examples examples_of(const std::vector<SlipRun>& runs) {
  Examples examples{kSlipInputs, 1, {}, {}};
  for (const SlipRun& run : runs) {
    for (std::size_t i = kMotionWindow; i + kMotionWindow < run.ticks.size(); i += kDecimation) {
      const SlipTick& tick = run.ticks[i];
      if (!tick.running || !tick.evaluated) continue;
      const double motion = travel_share(run, i - kMotionWindow, i + kMotionWindow);
      if (motion >= kAmbiguousMin && motion <= kAmbiguousMax) continue;
      for (const std::int16_t input : tick.inputs) {
        examples.in.push_back(static_cast<float>(to_value(input)));
      }
      examples.out.push_back(motion < kHeldShare ? 1.0F : 0.0F);
    }
  }
  return examples;
}

/// Means and deviations of the inputs: learned on inputs of mean 0 and deviation 1, then folded
/// into the first layer.
struct InputStatistics {
  std::array<double, kSlipInputs> mean{};
  std::array<double, kSlipInputs> deviation{};
};

InputStatistics statistics_of(const Examples& examples) {
  InputStatistics statistics;
  const auto rows = static_cast<double>(examples.rows());
  for (std::size_t i = 0; i < kSlipInputs; ++i) {
    double sum = 0.0;
    double squares = 0.0;
    for (std::size_t at = i; at < examples.in.size(); at += kSlipInputs) {
      const auto value = static_cast<double>(examples.in[at]);
      sum += value;
      squares += value * value;
    }
    statistics.mean[i] = sum / rows;
    statistics.deviation[i] =
        std::sqrt(std::max(squares / rows - statistics.mean[i] * statistics.mean[i], 1e-12));
  }
  return statistics;
}

Examples standardised(Examples examples, const InputStatistics& statistics) {
  for (std::size_t at = 0; at < examples.in.size(); ++at) {
    const std::size_t i = at % kSlipInputs;
    examples.in[at] = static_cast<float>(
        (static_cast<double>(examples.in[at]) - statistics.mean[i]) / statistics.deviation[i]);
  }
  return examples;
}

void fold(const InputStatistics& statistics, FloatLayer& first) {
  for (std::size_t node = 0; node < first.outputs; ++node) {
    for (std::size_t i = 0; i < kSlipInputs; ++i) {
      double& weight = first.weights[node * kSlipInputs + i];
      weight /= statistics.deviation[i];
      first.bias[node] -= weight * statistics.mean[i];
    }
  }
}

/// Mean cross entropy.
double error_of(NetworkTrainer& trainer, const Examples& examples) {
  const std::vector<float> logits = trainer.outputs(examples);
  double sum = 0.0;
  for (std::size_t i = 0; i < logits.size(); ++i) {
    const auto logit = static_cast<double>(logits[i]);
    sum += std::log1p(std::exp(-std::abs(logit))) + std::max(logit, 0.0) -
           static_cast<double>(examples.out[i]) * logit;
  }
  return sum / static_cast<double>(logits.size());
}

}  // namespace

Model train_slip(const std::vector<SlipRun>& runs, const SlipTrainingOptions& options) {
  const Examples raw = examples_of(runs);
  if (raw.rows() < 1000) throw RunError("slip: fewer than 1000 ticks to learn from");
  const InputStatistics statistics = statistics_of(raw);
  const Examples examples = standardised(raw, statistics);
  NetworkConfiguration network;
  for (const Channel& input : kInputs) network.inputs.emplace_back(input.name);
  network.outputs = {kOutput.name};
  network.hidden = {options.hidden};
  network.limited = true;
  network.linear_output = true;
  network.loss = Loss::kLogistic;
  network.optimiser = OptimiserKind::kAdam;
  network.learning_rate = 0.01;
  network.final_rate = 0.02;
  network.batch = 256;
  network.epochs = options.epochs;
  NetworkTrainer trainer(network, options.seed);
  for (std::size_t epoch = 1; epoch <= options.epochs; ++epoch) {
    trainer.train_epoch(examples);
    if (options.progress) options.progress(epoch, error_of(trainer, examples));
  }

  ContentHash hash;
  for (const float value : raw.in) hash.add(static_cast<double>(value));
  for (const float value : raw.out) hash.add(static_cast<double>(value));
  Model model;
  model.name = "slip";
  model.description = "whether the robot hardly moves while its tracks turn, for its slip watch";
  model.seed = options.seed;
  model.training_data = hash.hex();
  std::vector<FloatLayer> layers = trainer.folded();
  fold(statistics, layers.front());
  for (double& weight : layers.back().weights) weight /= kOutput.half_range;
  for (double& bias : layers.back().bias) bias /= kOutput.half_range;
  ModelNetwork result{{}, {}, quantise(layers), std::move(layers), {}};
  for (const Channel& input : kInputs) {
    result.inputs.push_back({input.name, 0.0, input.half_range, ""});
  }
  result.outputs.push_back({kOutput.name, 0.0, kOutput.half_range, ""});
  result.golden = golden_vectors(result.network, kGoldenVectors, options.seed);
  model.networks.push_back(std::move(result));
  return model;
}

}  // namespace screed::nn
