// Drives to examples, a network to a model.
#include "nn/slip/slip_training.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "nn/slip/slip_examples.h"
#include "nn/training/input_statistics.h"
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

constexpr std::size_t kGoldenVectors = 8;

}  // namespace

double mean_cross_entropy(std::span<const float> logits, std::span<const float> wanted) {
  double sum = 0.0;
  for (std::size_t i = 0; i < logits.size(); ++i) {
    const auto logit = static_cast<double>(logits[i]);
    sum += std::log1p(std::exp(-std::abs(logit))) + std::max(logit, 0.0) -
           static_cast<double>(wanted[i]) * logit;
  }
  return sum / static_cast<double>(logits.size());
}

Model train_slip(const std::vector<SlipRun>& runs, const SlipTrainingOptions& options) {
  const Examples raw = slip_examples(runs);
  if (raw.rows() < 1000) throw RunError("slip: fewer than 1000 ticks to learn from");
  const InputStatistics statistics(raw);
  const Examples examples = statistics.standardised(raw);
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
    if (options.progress) {
      options.progress(epoch, mean_cross_entropy(trainer.outputs(examples), examples.out));
    }
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
  statistics.fold_into(layers.front());
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
