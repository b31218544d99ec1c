// The recurrent network learns what only a memory can know.
#include "nn/slip/gated_trainer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "host_sim/core/errors.h"

namespace screed::nn {
namespace {

/// A pulse of the first input says what the second half of a second is: held after a positive one,
/// free after a negative one; the share of travel is half or all.
std::vector<SlipStep> pulses(unsigned seed, std::size_t steps) {
  std::mt19937 random(seed);
  std::vector<SlipStep> sequence;
  bool held = false;
  for (std::size_t i = 0; i < steps; ++i) {
    SlipStep step{};
    const bool pulse = i % 12 == 0;
    if (pulse) held = random() % 2U == 0;
    if (pulse) step.inputs[0] = static_cast<std::int8_t>(held ? 120 : -120);
    step.forgets = i == 0;
    step.held = held ? 1.0F : 0.0F;
    step.held_weight = 1.0F;
    step.share = held ? 0.5F : 1.0F;
    step.share_weight = 0.15F;
    sequence.push_back(step);
  }
  return sequence;
}

std::vector<std::vector<SlipStep>> many() {
  std::vector<std::vector<SlipStep>> sequences;
  for (unsigned seed = 1; seed <= 40; ++seed) sequences.push_back(pulses(seed, 300));
  return sequences;
}

GatedTrainingOptions quick() {
  GatedTrainingOptions options;
  options.units = 4;
  options.epochs = 150;
  return options;
}

TEST(GatedTrainer, RemembersAPulse) {
  const GatedNetwork network = train_gated(many(), quick());
  GatedRunner runner(network.shape(), parameters_of(network));
  int right = 0;
  int all = 0;
  double error = 0.0;
  for (const SlipStep& step : pulses(99, 600)) {
    if (step.forgets) runner.forget();
    const auto outputs = runner.step(step.inputs);
    right += (outputs[0] > 0) == (step.held > 0.5F) ? 1 : 0;
    error += std::abs(outputs[1] / 4096.0 - static_cast<double>(step.share));
    ++all;
  }
  EXPECT_GT(right, all * 97 / 100);
  EXPECT_LT(error / all, 0.1);
}

TEST(GatedTrainer, TheGradientIsThatOfTheLoss) {
  std::vector<std::vector<SlipStep>> lanes;
  std::mt19937 random(4);
  for (unsigned lane = 0; lane < 3; ++lane) {
    lanes.push_back(pulses(lane, 60));
    for (SlipStep& step : lanes.back())
      for (std::int8_t& input : step.inputs) input = static_cast<std::int8_t>(random() % 100U);
    lanes.back()[30].forgets = true;
  }
  GatedNetwork network = random_network({kSlipInputs, 3, kSlipOutputs}, 2);
  // So small that nothing is cut, where the gradient is not that of the loss.
  network.candidates *= 0.2F;
  network.gates *= 0.2F;
  const GatedGradient at = gated_gradient(network, lanes);
  const auto check = [&](Eigen::MatrixXf GatedNetwork::*matrix, Eigen::Index row,
                         Eigen::Index column) {
    constexpr float kStep = 0.01F;
    GatedNetwork more = network;
    (more.*matrix)(row, column) += kStep;
    GatedNetwork less = network;
    (less.*matrix)(row, column) -= kStep;
    const double slope = (gated_gradient(more, lanes).loss - gated_gradient(less, lanes).loss) /
                         (2.0 * static_cast<double>(kStep));
    EXPECT_NEAR(static_cast<double>((at.gradient.*matrix)(row, column)), slope,
                0.02 * std::abs(slope) + 2e-4)
        << row << ", " << column;
  };
  for (Eigen::Index row = 0; row < 3; ++row) {
    for (const Eigen::Index column : {0, 1, 5, 12, 13, 15}) {
      check(&GatedNetwork::candidates, row, column);
      check(&GatedNetwork::gates, row, column);
    }
  }
  for (Eigen::Index row = 0; row < 2; ++row)
    for (Eigen::Index column = 0; column < 4; ++column) check(&GatedNetwork::outputs, row, column);
}

TEST(GatedTrainer, WeightsFitBytesAndTheLossFalls) {
  std::vector<double> losses;
  GatedTrainingOptions options = quick();
  options.progress = [&](std::size_t epoch, double loss) {
    EXPECT_EQ(epoch, losses.size() + 1);
    losses.push_back(loss);
  };
  const GatedNetwork network = train_gated(many(), options);
  ASSERT_EQ(losses.size(), 150U);
  EXPECT_LT(losses.back(), losses.front() / 3.0);
  EXPECT_EQ(network.gates, rounded(network).gates);
  EXPECT_EQ(network.candidates.rows(), 4);
  EXPECT_EQ(network.shape().inputs, kSlipInputs);
}

TEST(GatedTrainer, TheSameSeedGivesTheSameNetwork) {
  GatedTrainingOptions options = quick();
  options.epochs = 2;
  const auto one = parameters_of(train_gated(many(), options));
  EXPECT_EQ(parameters_of(train_gated(many(), options)), one);
  options.seed = 2;
  EXPECT_NE(parameters_of(train_gated(many(), options)), one);
}

TEST(GatedTrainer, RefusesToLearnFromNothing) {
  EXPECT_THROW(train_gated({}, quick()), RunError);
}

}  // namespace
}  // namespace screed::nn
