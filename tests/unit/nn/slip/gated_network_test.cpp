// The slip watch's recurrent network in integers against its formulas in floating point.
#include "nn/slip/gated_network.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

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

}  // namespace
}  // namespace screed::nn
