// The slip watch's recurrent network in integers against its formulas in floating point.
#include "nn/slip/gated_trainer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "host_sim/core/errors.h"

namespace screed::nn {
namespace {

constexpr GatedShape kShape = {5, 7, 2};

double cut(double value) {
  return std::clamp(value, -1.0, 1.0);
}

/// The header's formulas without rounding.
struct Reference {
  const GatedNetwork& network;
  Eigen::VectorXf states = Eigen::VectorXf::Zero(kShape.units);

  std::array<double, 2> step(const std::array<std::int8_t, 5>& inputs) {
    Eigen::VectorXf x(kShape.row_size());
    x(0) = 1.0F;
    for (int i = 0; i < 5; ++i) x(1 + i) = static_cast<float>(inputs[i]) / 128.0F;
    x.tail(kShape.units) = states;
    const Eigen::VectorXf candidates = network.candidates * x;
    const Eigen::VectorXf gates = network.gates * x;
    for (int i = 0; i < kShape.units; ++i) {
      const double open = (cut(static_cast<double>(gates(i))) + 1.0) / 2.0;
      states(i) += static_cast<float>(
          open * open * (cut(static_cast<double>(candidates(i))) - static_cast<double>(states(i))));
    }
    std::array<double, 2> outputs{};
    for (int i = 0; i < 2; ++i) {
      outputs[i] = static_cast<double>(network.outputs(i, 0));
      for (int k = 0; k < kShape.units; ++k)
        outputs[i] += static_cast<double>(network.outputs(i, 1 + k) * states(k));
    }
    return outputs;
  }
};

TEST(GatedNetwork, IntegersFollowTheFormulas) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const GatedNetwork network = rounded(random_network(kShape, seed));
    GatedRunner runner(kShape, parameters_of(network));
    Reference reference{network};
    std::mt19937 random(seed);
    for (int step = 0; step < 500; ++step) {
      std::array<std::int8_t, 5> inputs{};
      for (std::int8_t& input : inputs) input = static_cast<std::int8_t>(random());
      const auto outputs = runner.step(inputs);
      const auto expected = reference.step(inputs);
      for (int i = 0; i < 2; ++i)
        ASSERT_NEAR(outputs[i] / 4096.0, expected[i], 0.06) << "seed " << seed << " step " << step;
    }
  }
}

TEST(GatedNetwork, ForgettingIsABeginningAnew) {
  const std::vector<std::int8_t> parameters = parameters_of(random_network(kShape, 3));
  GatedRunner used(kShape, parameters);
  GatedRunner fresh(kShape, parameters);
  const std::array<std::int8_t, 5> inputs = {100, -50, 20, 127, -128};
  const auto first = fresh.step(inputs);
  const std::vector<std::int16_t> expected(first.begin(), first.end());
  for (int i = 0; i < 10; ++i) used.step(inputs);
  const auto later = used.step(inputs);
  EXPECT_NE(std::vector<std::int16_t>(later.begin(), later.end()), expected);
  used.forget();
  const auto again = used.step(inputs);
  EXPECT_EQ(std::vector<std::int16_t>(again.begin(), again.end()), expected);
}

TEST(GatedNetwork, SumsStopAtTheEndsOfSixteenBits) {
  const std::array<std::int8_t, 5> row = {127, 127, 127, 127, 127};
  const std::array<std::int8_t, 4> most = {127, 127, 127, 127};
  const std::array<std::int8_t, 4> least = {-128, -128, -128, -128};
  EXPECT_EQ(screed_nn_row8(row.data(), most.data(), 4), INT16_MAX);
  EXPECT_EQ(screed_nn_row8(row.data(), least.data(), 4), INT16_MIN);
  EXPECT_EQ(screed_nn_row8(row.data(), most.data(), 1), 127 * 128 + 127 * 127);
}

TEST(GatedNetwork, RoundingIsToTheNearestThirtySecondWithinAByte) {
  GatedNetwork network = random_network(kShape, 1);
  network.gates(2, 3) = 0.1F;   // 3.2 / 32
  network.gates(2, 4) = -9.0F;  // beyond
  network.outputs(1, 2) = 9.0F;
  const GatedNetwork of_bytes = rounded(network);
  EXPECT_EQ(of_bytes.gates(2, 3), 3.0F / 32.0F);
  EXPECT_EQ(of_bytes.gates(2, 4), -127.0F / 32.0F);
  EXPECT_EQ(of_bytes.outputs(1, 2), 127.0F / 32.0F);
  const std::vector<std::int8_t> parameters = parameters_of(network);
  ASSERT_EQ(parameters.size(), kShape.size());
  EXPECT_EQ(parameters[kShape.gates_begin() + 2 * kShape.row_size() + 3], 3);
  EXPECT_EQ(parameters[kShape.gates_begin() + 2 * kShape.row_size() + 4], -127);
  EXPECT_EQ(parameters[kShape.outputs_begin() + 8 + 2], 127);
}

// ---- The recurrent network learns what only a memory can know

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
