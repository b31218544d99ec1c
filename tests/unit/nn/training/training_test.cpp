// Training: the optimisers against the published rules, gradients against differences, batch
// normalisation and steepness folded against tiny-dnn itself, and that a training goes on where it
// stopped.
#include <gtest/gtest.h>

#include <cmath>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/training/network_trainer.h"
#include "nn/training/predict.h"
#include "nn/training/trainer.h"

namespace screed::nn {
namespace {

Examples random_examples(std::size_t rows) {
  Examples examples{2, 1, {}, {}};
  WorldRandom random(3, "examples");
  for (std::size_t i = 0; i < rows; ++i) {
    const double a = random.uniform(-1.0, 1.0);
    const double b = random.uniform(-1.0, 1.0);
    examples.in.push_back(static_cast<float>(a));
    examples.in.push_back(static_cast<float>(b));
    examples.out.push_back(static_cast<float>(0.5 * a * b + 0.2 * a - 0.1));
  }
  return examples;
}

NetworkConfiguration small_network(BatchNormalisation norm, bool linear) {
  NetworkConfiguration network;
  network.inputs = {"v_left", "v_right"};
  network.outputs = {"v"};
  network.hidden = {5, 4};
  network.linear_output = linear;
  network.steepness = 0.5;
  network.batch_normalisation = norm;
  network.optimiser = OptimiserKind::kAdam;
  network.learning_rate = 0.01;
  network.batch = 16;
  return network;
}

double loss(const std::vector<float>& out, const Examples& examples) {
  double sum = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double error = static_cast<double>(out[i]) - static_cast<double>(examples.out[i]);
    sum += error * error;
  }
  return sum / static_cast<double>(out.size());
}

TEST(NetworkTrainer, AnEpochThatIsStoppedLeavesTheStateBeforeIt) {
  const NetworkConfiguration network = small_network(BatchNormalisation::kScaled, true);
  const Examples examples = random_examples(2100);  // three chunks of batches
  int asked = 0;
  const auto in_the_midst = [&] { return ++asked == 2; };
  const auto never = [] { return false; };
  const auto stopped = make_network_trainer(network, 7);
  const auto other = make_network_trainer(network, 7);
  EXPECT_TRUE(stopped->train_epoch(examples, never));
  EXPECT_TRUE(other->train_epoch(examples, {}));
  EXPECT_FALSE(stopped->train_epoch(examples, in_the_midst));
  EXPECT_EQ(asked, 2);
  EXPECT_EQ(stopped->state().epochs, 1U);
  EXPECT_EQ(stopped->state().parameters, other->state().parameters);
  EXPECT_TRUE(stopped->train_epoch(examples, never));
  EXPECT_TRUE(other->train_epoch(examples, {}));
  EXPECT_EQ(stopped->state().parameters, other->state().parameters);
}

// f = (x - 1)^2 + 10 (y + 2)^2 from (4, 4), worked out step by step from the rule of Igel and
// Huesken (2000): x: 3.9, 3.78, 3.636, ...; y: likewise while the signs stay.
TEST(Optimisers, IrpropMinusFollowsThePublishedRule) {
  std::vector<float> at = {4.0F, 1.0F};
  UpdateState state;
  const auto step = [&](float gx, float gy) {
    const float gradient[] = {gx, gy};
    update_parameters(OptimiserKind::kIrprop, 9.9, 0.0, gradient, at, state);
  };
  step(6.0F, 2.0F);  // first steps: 0.1 against the sign
  EXPECT_FLOAT_EQ(at[0], 3.9F);
  EXPECT_FLOAT_EQ(at[1], 0.9F);
  step(5.0F, -1.0F);  // x: the sign stays, 0.12. y: it changes, the step halves and is not taken
  EXPECT_FLOAT_EQ(at[0], 3.78F);
  EXPECT_FLOAT_EQ(at[1], 0.9F);
  step(4.0F, -1.0F);  // y: the gradient before counts as 0: the halved step, not grown
  EXPECT_FLOAT_EQ(at[0], 3.636F);
  EXPECT_FLOAT_EQ(at[1], 0.95F);
  step(0.0F, -1.0F);  // x: no gradient, no step. y: grows to 0.06
  EXPECT_FLOAT_EQ(at[0], 3.636F);
  EXPECT_FLOAT_EQ(at[1], 1.01F);
}

TEST(Optimisers, IrpropMinusFindsTheLowestPointOfABowl) {
  std::vector<float> at = {4.0F, 4.0F};
  UpdateState state;
  for (int i = 0; i < 100; ++i) {
    const float gradient[] = {2.0F * (at[0] - 1.0F), 20.0F * (at[1] + 2.0F)};
    update_parameters(OptimiserKind::kIrprop, 0.0, 0.0, gradient, at, state);
  }
  EXPECT_NEAR(at[0], 1.0, 1e-3);
  EXPECT_NEAR(at[1], -2.0, 1e-3);
}

TEST(Optimisers, SgdDecaysWeights) {
  std::vector<float> at = {2.0F};
  UpdateState state;
  const float gradient[] = {0.5F};
  update_parameters(OptimiserKind::kSgd, 0.1, 0.25, gradient, at, state);
  EXPECT_FLOAT_EQ(at[0], 2.0F - 0.1F * (0.5F + 2.0F * 0.25F * 2.0F));
}

TEST(Optimisers, AdamsFirstStepIsTheLearningRate) {
  // Both means are corrected for their start: any gradient gives the same first step.
  std::vector<float> at = {1.0F, 1.0F};
  UpdateState state;
  const float gradient[] = {1e-3F, -50.0F};
  update_parameters(OptimiserKind::kAdam, 0.01, 0.0, gradient, at, state);
  EXPECT_NEAR(at[0], 0.99, 1e-6);
  EXPECT_NEAR(at[1], 1.01, 1e-6);
  // Second step by hand: m = 0.19, v = 0.001999; / (1 - 0.81), / (1 - 0.998001).
  std::vector<float> one = {0.0F};
  UpdateState second;
  for (const float g : {1.0F, 1.0F}) {
    const float same[] = {g};
    update_parameters(OptimiserKind::kAdam, 0.01, 0.0, same, one, second);
  }
  EXPECT_NEAR(one[0], -0.02, 1e-6);
}

TEST(Trainer, GradientsAreThoseOfTheLoss) {
  // Without batch normalisation the loss is a function of the parameters alone.
  const auto trainer = make_network_trainer(small_network(BatchNormalisation::kNone, false), 7);
  const Examples examples = random_examples(24);
  const std::vector<std::vector<float>> gradient = trainer->gradient(examples);
  const TrainerState state = trainer->state();
  ASSERT_EQ(gradient.size(), state.parameters.size());
  for (std::size_t array = 0; array < gradient.size(); ++array) {
    for (std::size_t i = 0; i < gradient[array].size(); ++i) {
      constexpr float kStep = 1e-2F;
      TrainerState moved = state;
      moved.parameters[array][i] += kStep;
      trainer->restore(moved);
      const double above = loss(trainer->outputs(examples), examples);
      moved.parameters[array][i] -= 2.0F * kStep;
      trainer->restore(moved);
      const double below = loss(trainer->outputs(examples), examples);
      EXPECT_NEAR(gradient[array][i], (above - below) / 2e-2, 2e-4) << array << " " << i;
    }
  }
}

/// The loss with batch normalisation by the batch's own means, in double precision.
double normalised_loss(const TrainerState& state, const Examples& examples, double steepness) {
  const std::size_t widths[] = {2, 5, 4, 1};
  const std::size_t rows = examples.rows();
  std::vector<std::vector<double>> values(rows);
  for (std::size_t row = 0; row < rows; ++row) {
    values[row].assign(examples.in.begin() + static_cast<std::ptrdiff_t>(2 * row),
                       examples.in.begin() + static_cast<std::ptrdiff_t>(2 * row + 2));
  }
  std::size_t array = 0;
  for (std::size_t layer = 0; layer < 3; ++layer, array += 6) {
    const std::size_t inputs = widths[layer];
    const std::size_t outputs = widths[layer + 1];
    std::vector<std::vector<double>> sums(rows, std::vector<double>(outputs));
    for (std::size_t row = 0; row < rows; ++row) {
      for (std::size_t o = 0; o < outputs; ++o) {
        sums[row][o] = static_cast<double>(state.parameters[array + 1][o]);
        for (std::size_t i = 0; i < inputs; ++i) {
          sums[row][o] +=
              static_cast<double>(state.parameters[array][i * outputs + o]) * values[row][i];
        }
      }
    }
    for (std::size_t o = 0; o < outputs; ++o) {
      double mean = 0.0;
      double variance = 0.0;
      for (const auto& row : sums) mean += row[o] / static_cast<double>(rows);
      // tiny-dnn divides by n - 1.
      for (const auto& row : sums) {
        variance += (row[o] - mean) * (row[o] - mean) / static_cast<double>(rows - 1);
      }
      for (auto& row : sums) {
        const double normal = (row[o] - mean) / std::sqrt(variance + 1e-5);
        row[o] =
            std::tanh(steepness * (static_cast<double>(state.parameters[array + 2][o]) * normal +
                                   static_cast<double>(state.parameters[array + 3][o])));
      }
    }
    values = sums;
  }
  double sum = 0.0;
  for (std::size_t row = 0; row < rows; ++row) {
    const double error = values[row][0] - static_cast<double>(examples.out[row]);
    sum += error * error;
  }
  return sum / static_cast<double>(rows);
}

TEST(Trainer, GradientsThroughBatchNormalisationWithScale) {
  const auto trainer = make_network_trainer(small_network(BatchNormalisation::kScaled, false), 7);
  const Examples examples = random_examples(1024);
  const std::vector<std::vector<float>> gradient = trainer->gradient(examples);
  const TrainerState state = trainer->state();
  // Arrays a layer: weights, biases, scales, offsets; the state has means and variances behind.
  for (std::size_t layer = 0; layer < 3; ++layer) {
    for (std::size_t kind = 0; kind < 4; ++kind) {
      const std::vector<float>& part = gradient[4 * layer + kind];
      for (std::size_t i = 0; i < part.size(); ++i) {
        constexpr float kStep = 1e-3F;
        TrainerState above = state;
        TrainerState below = state;
        above.parameters[6 * layer + kind][i] += kStep;
        below.parameters[6 * layer + kind][i] -= kStep;
        const double width = static_cast<double>(above.parameters[6 * layer + kind][i]) -
                             static_cast<double>(below.parameters[6 * layer + kind][i]);
        const double slope =
            (normalised_loss(above, examples, 0.5) - normalised_loss(below, examples, 0.5)) / width;
        // Its backward pass takes n for the n - 1 of the variance: right to one part in a thousand.
        EXPECT_NEAR(part[i], slope, 2e-4 + 0.005 * std::abs(slope))
            << "layer " << layer << " kind " << kind << " " << i;
      }
    }
  }
}

TEST(Trainer, FoldedLayersGiveWhatTinyDnnGives) {
  for (const BatchNormalisation norm :
       {BatchNormalisation::kNone, BatchNormalisation::kPlain, BatchNormalisation::kScaled}) {
    for (const bool linear : {false, true}) {
      const auto trainer = make_network_trainer(small_network(norm, linear), 11);
      const Examples examples = random_examples(200);
      for (int epoch = 0; epoch < 3; ++epoch) trainer->train_epoch(examples, {});
      const std::vector<float> theirs = trainer->outputs(examples);
      const std::vector<double> ours = predict(trainer->folded(), examples);
      for (std::size_t i = 0; i < theirs.size(); ++i) {
        const double value = std::clamp(static_cast<double>(theirs[i]), -1.0, 1.0);
        ASSERT_NEAR(ours[i], value, 2e-5) << static_cast<int>(norm) << linear << i;
      }
    }
  }
}

TEST(Trainer, LearnsAndTheIntegersFollow) {
  const auto trainer = make_network_trainer(small_network(BatchNormalisation::kNone, false), 1);
  const Examples examples = random_examples(400);
  const double before = loss(trainer->outputs(examples), examples);
  for (int epoch = 0; epoch < 60; ++epoch) trainer->train_epoch(examples, {});
  const double after = loss(trainer->outputs(examples), examples);
  EXPECT_LT(after, 0.05 * before);
  const std::vector<double> in_float = predict(trainer->folded(), examples);
  const std::vector<double> in_integers = predict(quantise(trainer->folded()), examples);
  for (std::size_t i = 0; i < in_float.size(); ++i) {
    ASSERT_NEAR(in_float[i], in_integers[i], 1e-3);
  }
}

TEST(Trainer, GoesOnFromAStateAsIfItHadNeverStopped) {
  const Examples examples = random_examples(100);
  for (const OptimiserKind kind :
       {OptimiserKind::kIrprop, OptimiserKind::kSgd, OptimiserKind::kAdam}) {
    NetworkConfiguration network = small_network(BatchNormalisation::kScaled, false);
    network.optimiser = kind;
    const auto through = make_network_trainer(network, 5);
    for (int epoch = 0; epoch < 4; ++epoch) through->train_epoch(examples, {});
    const auto first = make_network_trainer(network, 5);
    for (int epoch = 0; epoch < 2; ++epoch) first->train_epoch(examples, {});
    const auto second = make_network_trainer(network, 99);
    second->restore(first->state());
    const auto third = make_network_trainer(network, 5);
    third->restore(first->state());
    for (int epoch = 0; epoch < 2; ++epoch) third->train_epoch(examples, {});
    EXPECT_EQ(third->state().parameters, through->state().parameters);
    EXPECT_EQ(second->state().parameters, first->state().parameters);
  }
  const auto other = make_network_trainer(small_network(BatchNormalisation::kNone, false), 5);
  const auto plain = make_network_trainer(small_network(BatchNormalisation::kPlain, false), 5);
  EXPECT_THROW(other->restore(plain->state()), InputError);
}

/// Says losses as they were made up, and notes what it is asked for.
class MadeUpTrainer : public Trainer {
 public:
  explicit MadeUpTrainer(std::vector<double> losses) : losses_(std::move(losses)) {}

  std::optional<EpochLoss> train_epoch(std::size_t epoch,
                                       const std::function<bool()>& stop) override {
    if (stop && stop()) return std::nullopt;
    trained = epoch + 1;
    return EpochLoss{-1.0, losses_.at(epoch)};
  }
  void keep() override { kept.push_back(trained); }
  void checkpoint() override { checkpoints.push_back(trained); }

  std::size_t trained = 0;
  std::vector<std::size_t> kept, checkpoints;

 private:
  std::vector<double> losses_;
};

TEST(RunTraining, KeepsTheBestAndStopsWhenItGetsNoBetter) {
  const std::vector<double> course = {5.0, 3.0, 4.0, 3.0, 3.5, 1.0};
  MadeUpTrainer patient(course);
  std::vector<EpochLoss> losses;
  std::vector<double> shares;
  TrainingPlan plan{.epochs = 6, .patience = 3, .keep_best = true};
  plan.progress = [&](const auto& /*so_far*/, double share) { shares.push_back(share); };
  run_training(patient, plan, losses);
  EXPECT_EQ(losses.size(), 5U);
  EXPECT_EQ(patient.kept, (std::vector<std::size_t>{1, 2}));
  EXPECT_EQ(shares, (std::vector<double>{1.0 / 6, 2.0 / 6, 3.0 / 6, 4.0 / 6, 1.0}));
  MadeUpTrainer last(course);
  losses.clear();
  run_training(last, {.epochs = 6}, losses);
  EXPECT_EQ(last.kept, (std::vector<std::size_t>{1, 2, 3, 4, 5, 6}));
}

TEST(RunTraining, ACheckpointIsMadeWhenItIsStoppedAndGoesOnFromThere) {
  const std::vector<double> course = {5.0, 3.0, 4.0, 4.0, 1.0, 9.0};
  MadeUpTrainer stopped(course);
  std::vector<EpochLoss> losses;
  TrainingPlan plan{.epochs = 200, .patience = 2, .keep_best = true};
  plan.stop = [&] { return stopped.trained == 3; };
  run_training(stopped, plan, losses);
  EXPECT_EQ(losses.size(), 3U);
  EXPECT_EQ(stopped.checkpoints, (std::vector<std::size_t>{3})) << "every fourth, and at the end";
  MadeUpTrainer resumed(course);
  plan.stop = {};
  run_training(resumed, plan, losses);
  EXPECT_EQ(losses.size(), 4U) << "the second epoch was the best, two ago";
  EXPECT_TRUE(resumed.kept.empty());
  EXPECT_EQ(resumed.checkpoints, (std::vector<std::size_t>{4}));
}

TEST(Measures, AgainstValuesByHand) {
  const std::vector<double> real = {1.0, 2.0, 3.0, 4.0};
  const std::vector<double> twice = {2.0, 4.0, 6.0, 8.0};
  const std::vector<double> bent = {1.0, 10.0, 100.0, 1000.0};
  EXPECT_DOUBLE_EQ(mean_squared_error(real, twice), (1.0 + 4.0 + 9.0 + 16.0) / 4.0);
  EXPECT_NEAR(squared_correlation(real, twice), 1.0, 1e-12);
  EXPECT_NEAR(explained_variance(real, twice), 1.0 - 30.0 / 5.0, 1e-12);
  EXPECT_NEAR(spearman(real, bent), 1.0, 1e-12);
  // Ranks 0, 1.5, 1.5, 3 against 0..3: 4.5 / sqrt(4.5 * 5).
  const std::vector<double> tied = {1.0, 5.0, 5.0, 9.0};
  EXPECT_NEAR(spearman(real, tied), 4.5 / std::sqrt(4.5 * 5.0), 1e-12);
  EXPECT_EQ(squared_correlation(real, std::vector<double>(4, 1.0)), 0.0);
}

}  // namespace
}  // namespace screed::nn
