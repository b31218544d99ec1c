// Drives to examples, a network to a model.
#include "nn/slip/slip_training.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/errors.h"
#include "nn/training/network_trainer.h"

namespace screed::nn {
namespace {

// Two: shares of up to 2 as Q14. The other ranges are those of slip_watch.h.
struct Channel {
  const char* name;
  double half_range;
};
constexpr Channel kInputs[] = {{"inertial_slip", 2.0},    {"turn", 2.0},
                               {"track_difference", 2.0}, {"faster_track", 0.4096},
                               {"sin_pitch", 2.0},        {"effort", 512.0}};
static_assert(std::size(kInputs) == kSlipInputs);
constexpr Channel kOutput = {"speed_share", 2.0};

constexpr std::size_t kEvery = 3;   // ticks: neighbours say much the same
constexpr std::size_t kWeight = 4;  // of a tick at which the robot hardly moves
constexpr double kHardly = 0.3;     // share of motion
constexpr double kSmoothing = 1.0 / 16.0;
constexpr std::size_t kGoldenVectors = 8;

Examples examples_of(const std::vector<SlipRun>& runs) {
  Examples examples{kSlipInputs, 1, {}, {}};
  for (const SlipRun& run : runs) {
    double speed = 0.0;
    double turn = 0.0;
    for (std::size_t i = 0; i < run.ticks.size(); ++i) {
      const SlipTick& tick = run.ticks[i];
      speed += (static_cast<double>(tick.speed) - speed) * kSmoothing;
      turn += (static_cast<double>(tick.turn) - turn) * kSmoothing;
      if (!tick.running || !tick.looked || i % kEvery != 0) continue;
      const double faster = std::max(0.03, static_cast<double>(tick.faster));
      const double share = std::clamp((tick.backwards ? -speed : speed) / faster, -0.2, 1.2);
      const double motion = std::abs(share) + std::abs(turn) / faster;
      for (std::size_t copy = 0; copy < (motion < kHardly ? kWeight : 1); ++copy) {
        for (const std::int16_t input : tick.inputs) {
          examples.in.push_back(static_cast<float>(to_value(input)));
        }
        examples.out.push_back(static_cast<float>(share / kOutput.half_range));
      }
    }
  }
  return examples;
}

double error_of(NetworkTrainer& trainer, const Examples& examples) {
  const std::vector<float> outputs = trainer.outputs(examples);
  double sum = 0.0;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const double difference =
        static_cast<double>(outputs[i]) - static_cast<double>(examples.out[i]);
    sum += difference * difference;
  }
  return std::sqrt(sum / static_cast<double>(outputs.size())) * kOutput.half_range;
}

}  // namespace

Model train_slip(const std::vector<SlipRun>& runs, const SlipTrainingOptions& options) {
  const Examples examples = examples_of(runs);
  if (examples.rows() < 1000) throw RunError("slip: fewer than 1000 ticks to learn from");
  NetworkConfiguration network;
  for (const Channel& input : kInputs) network.inputs.emplace_back(input.name);
  network.outputs = {kOutput.name};
  network.hidden = {options.hidden};
  network.limited = true;
  network.linear_output = true;
  network.optimiser = OptimiserKind::kAdam;
  network.learning_rate = 0.004;
  network.final_rate = 0.02;
  network.batch = 256;
  network.epochs = options.epochs;
  NetworkTrainer trainer(network, options.seed);
  for (std::size_t epoch = 1; epoch <= options.epochs; ++epoch) {
    trainer.train_epoch(examples);
    if (options.progress) options.progress(epoch, error_of(trainer, examples));
  }

  ContentHash hash;
  for (const float value : examples.in) hash.add(static_cast<double>(value));
  for (const float value : examples.out) hash.add(static_cast<double>(value));
  Model model;
  model.name = "slip";
  model.description = "what the chassis makes of the tracks' speed, for the robot's slip watch";
  model.seed = options.seed;
  model.training_data = hash.hex();
  std::vector<FloatLayer> layers = trainer.folded();
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
