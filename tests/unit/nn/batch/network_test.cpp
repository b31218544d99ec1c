// Networks in integers: quantiser, arithmetic, and the batched engine against it bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "nn/batch/batch_network.h"
#include "nn/model/quantiser.h"

namespace screed::nn {
namespace {

std::vector<FloatLayer> random_network(WorldRandom& random, const std::vector<std::size_t>& widths,
                                       double greatest_weight, bool linear_end = false) {
  std::vector<FloatLayer> layers;
  for (std::size_t i = 1; i < widths.size(); ++i) {
    FloatLayer layer{widths[i - 1], widths[i], linear_end && i + 1 == widths.size(), {}, {}};
    for (std::size_t n = 0; n < layer.inputs * layer.outputs; ++n) {
      layer.weights.push_back(random.uniform(-greatest_weight, greatest_weight));
    }
    for (std::size_t n = 0; n < layer.outputs; ++n) layer.bias.push_back(random.uniform(-0.5, 0.5));
    layers.push_back(layer);
  }
  return layers;
}

double worst_error(const std::vector<FloatLayer>& layers, WorldRandom& random, int vectors) {
  const IntegerNetwork network = quantise(layers);
  double worst = 0.0;
  std::vector<std::int16_t> in(network.inputs());
  std::vector<std::int16_t> out(network.outputs());
  for (int n = 0; n < vectors; ++n) {
    std::vector<double> values(network.inputs());
    for (std::size_t i = 0; i < in.size(); ++i) {
      values[i] = random.uniform(-1.0, 1.0);
      in[i] = to_activation(values[i]);
    }
    network.run(in, out);
    const std::vector<double> expected = run(layers, values);
    for (std::size_t i = 0; i < out.size(); ++i) {
      worst = std::max(worst, std::abs(to_value(out[i]) - std::clamp(expected[i], -1.0, 1.0)));
    }
  }
  return worst;
}

TEST(Network, TanhIsOddAndWithinItsBound) {
  for (int z = INT16_MIN; z <= INT16_MAX; ++z) {
    const auto argument = static_cast<std::int16_t>(z);
    const double value = (tanh_q15(argument) + 0.5) / 32768.0;
    ASSERT_NEAR(value, std::tanh((z + 0.5) / 8192.0), 7.5e-5) << z;
    ASSERT_EQ(tanh_q15(static_cast<std::int16_t>(~z)), ~tanh_q15(argument)) << z;
    if (z > INT16_MIN) {
      ASSERT_GE(tanh_q15(argument), tanh_q15(static_cast<std::int16_t>(z - 1))) << z;
    }
  }
}

TEST(Network, AStepOfTheArithmeticByHand) {
  // One node, w = 1/2 and -1/4, b = 1/8, at inputs 0.6 and -0.4: argument 0.525.
  const std::vector<FloatLayer> layers = {{2, 1, false, {0.5, -0.25}, {0.125}}};
  const IntegerNetwork network = quantise(layers);
  EXPECT_EQ(network.layers()[0].gain_shift, 0);
  EXPECT_EQ(network.layers()[0].weights, (std::vector<std::int16_t>{8192, -4096}));
  // 1/8 * 2^29 + (8192 - 4096) / 2
  EXPECT_EQ(network.layers()[0].bias, (std::vector<std::int32_t>{67108864 + 2048}));
  const std::vector<std::int16_t> in = {to_activation(0.6), to_activation(-0.4)};
  std::vector<std::int16_t> out(1);
  network.run(in, out);
  EXPECT_NEAR(to_value(out[0]), std::tanh(0.525), 1e-4);
}

TEST(Network, ALinearNodeGivesItsSumAndStopsAtOne) {
  const IntegerNetwork network = quantise({{1, 1, true, {1.5}, {0.0}}});
  std::vector<std::int16_t> out(1);
  network.run(std::vector<std::int16_t>{to_activation(0.5)}, out);
  EXPECT_NEAR(to_value(out[0]), 0.75, 1.0 / 32768);
  network.run(std::vector<std::int16_t>{to_activation(0.9)}, out);
  EXPECT_EQ(out[0], INT16_MAX);
  network.run(std::vector<std::int16_t>{to_activation(-0.9)}, out);
  EXPECT_EQ(out[0], INT16_MIN);
}

TEST(Network, QuantisationErrorStaysSmall) {
  WorldRandom random(1, "network");
  EXPECT_LE(worst_error(random_network(random, {4, 20, 1}, 0.7), random, 20000), 1e-3);
  const std::vector<std::size_t> deep = {4, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 7, 1};
  EXPECT_LE(worst_error(random_network(random, deep, 0.7), random, 20000), 3e-3);
  EXPECT_LE(worst_error(random_network(random, {6, 16, 2}, 1.5, true), random, 20000), 2e-3);
}

/// Rows of four inputs that move together in part, as those of a robot do.
std::vector<double> rows_of_inputs(WorldRandom& random, int count) {
  std::vector<double> rows;
  for (int n = 0; n < count; ++n) {
    const double a = random.uniform(-0.7, 0.7);
    const double b = random.uniform(-0.3, 0.3);
    for (const double value : {a + b, a - b, random.uniform(-0.4, 0.4), 0.2 + 0.5 * a}) {
      rows.push_back(value);
    }
  }
  return rows;
}

struct Off {
  double mean = 0.0;
  double square = 0.0;
};

Off off(const IntegerNetwork& network, const std::vector<FloatLayer>& layers,
        const std::vector<double>& rows) {
  Off result;
  const double count = static_cast<double>(rows.size()) / 4.0;
  for (std::size_t row = 0; row < rows.size(); row += 4) {
    const std::vector<double> values(rows.begin() + static_cast<std::ptrdiff_t>(row),
                                     rows.begin() + static_cast<std::ptrdiff_t>(row + 4));
    std::vector<std::int16_t> in(values.size());
    std::transform(values.begin(), values.end(), in.begin(), to_activation);
    std::vector<std::int16_t> out(1);
    network.run(in, out);
    const double error = to_value(out[0]) - run(layers, values)[0];
    result.mean += error / count;
    result.square += error * error / count;
  }
  return result;
}

TEST(Network, IntegersFittedToTheirInputsComeCloser) {
  WorldRandom random(4, "network");
  const std::vector<double> rows = rows_of_inputs(random, 3000);
  const std::vector<double> others = rows_of_inputs(random, 3000);
  Off plain;
  Off fitted;
  for (int n = 0; n < 6; ++n) {
    // Great weights make a coarse scale: there the rounding of weights is most of the error.
    const std::vector<FloatLayer> layers =
        random_network(random, {4, 7, 7, 7, 7, 1}, n % 2 == 0 ? 0.9 : 3.0);
    const IntegerNetwork network = quantise(layers, rows);
    for (std::size_t i = 0; i < layers.size(); ++i) {
      EXPECT_EQ(network.layers()[i].gain_shift, quantise(layers).layers()[i].gain_shift);
      EXPECT_LE(network.layers()[i].max_abs_sum(), std::numeric_limits<std::int32_t>::max());
    }
    const Off before = off(quantise(layers), layers, others);
    const Off after = off(network, layers, others);
    plain.mean += std::abs(before.mean);
    plain.square += before.square;
    fitted.mean += std::abs(after.mean);
    fitted.square += after.square;
  }
  EXPECT_LT(fitted.mean, 0.3 * plain.mean);
  EXPECT_LT(fitted.square, 0.5 * plain.square);
}

TEST(Network, FittedToInputsThatNeverChangeIsStillTheNetwork) {
  WorldRandom random(5, "network");
  const std::vector<FloatLayer> layers = random_network(random, {4, 7, 7, 1}, 0.7);
  std::vector<double> rows;
  for (int n = 0; n < 50; ++n) rows.insert(rows.end(), {0.5, 0.5, -0.25, 1.5});
  const Off everywhere = off(quantise(layers, rows), layers, rows_of_inputs(random, 1000));
  EXPECT_LT(everywhere.square, 1e-7);
  // No rows: the same integers as without.
  const IntegerNetwork plain = quantise(layers);
  const IntegerNetwork same = quantise(layers, std::vector<double>{});
  for (std::size_t i = 0; i < layers.size(); ++i) {
    EXPECT_EQ(same.layers()[i].weights, plain.layers()[i].weights);
    EXPECT_EQ(same.layers()[i].bias, plain.layers()[i].bias);
  }
}

TEST(Network, TheQuantiserProvesThatNoSumOverflows) {
  WorldRandom random(2, "network");
  for (const double greatest : {0.1, 1.0, 10.0, 100.0, 1000.0}) {
    const IntegerNetwork network = quantise(random_network(random, {20, 7, 3}, greatest));
    for (const IntegerLayer& layer : network.layers()) {
      EXPECT_LE(layer.max_abs_sum(), std::numeric_limits<std::int32_t>::max());
      // A finer scale would not have been possible.
      if (layer.gain_shift > 0) {
        std::int16_t greatest_weight = 0;
        for (const std::int16_t w : layer.weights) {
          greatest_weight =
              std::max<std::int16_t>(greatest_weight, static_cast<std::int16_t>(std::abs(w)));
        }
        EXPECT_TRUE(2 * greatest_weight > INT16_MAX ||
                    2 * layer.max_abs_sum() > std::numeric_limits<std::int32_t>::max());
      }
    }
  }
}

TEST(Network, WhatCannotBeRepresentedIsRefusedWithItsLayer) {
  const auto message = [](const std::vector<FloatLayer>& layers) -> std::string {
    try {
      quantise(layers);
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(message({}), "network: no layers; allowed is one or more");
  EXPECT_EQ(message({{1, 1, false, {1e5}, {0.0}}}),
            "network: layer 1: weights are too large for 16 bits at any scale");
  EXPECT_EQ(message({{1, 2, false, {1.0, 1.0}, {0.0, 0.0}}, {3, 1, false, {1, 1, 1}, {0}}}),
            "network: layer 2: 3 inputs after 2 outputs; they must be equal");
  EXPECT_EQ(message({{1, 1, false, {std::nan("")}, {0.0}}}),
            "network: layer 1: a weight or bias is not finite");
  EXPECT_EQ(message({{2, 1, false, {1.0}, {0.0}}}),
            "network: layer 1: dimensions do not fit together; allowed is 1 to 255 a side");
}

class Batch : public ::testing::TestWithParam<InstructionSet> {};

TEST_P(Batch, GivesTheBitsOfTheScalarArithmetic) {
  WorldRandom random(3, "network");
  const std::vector<std::vector<std::size_t>> shapes = {
      {4, 20, 1}, {4, 7, 7, 7, 2}, {1, 1}, {5, 33, 3}, {255, 2}, {3, 255, 255, 1}, {4, 31, 64}};
  for (const std::vector<std::size_t>& shape : shapes) {
    for (const double greatest : {0.5, 8.0}) {
      const IntegerNetwork network =
          quantise(random_network(random, shape, greatest, shape.size() % 2 == 0));
      const BatchNetwork batch(network, GetParam());
      for (const std::size_t robots : {1U, 3U, 4U, 15U, 16U, 17U, 35U, 36U, 77U}) {
        const std::size_t stride = robots + 3;
        std::vector<std::int16_t> in(stride * network.inputs());
        for (std::int16_t& value : in) {
          const std::uint64_t bits = random.next();
          value = bits % 8 == 0   ? INT16_MIN
                  : bits % 8 == 1 ? INT16_MAX
                                  : static_cast<std::int16_t>(bits >> 8);
        }
        std::vector<std::int16_t> out(stride * network.outputs(), 77);
        batch.run(in.data(), out.data(), robots, stride);
        std::vector<std::int16_t> one_in(network.inputs());
        std::vector<std::int16_t> one_out(network.outputs());
        for (std::size_t robot = 0; robot < robots; ++robot) {
          for (std::size_t i = 0; i < one_in.size(); ++i) one_in[i] = in[i * stride + robot];
          network.run(one_in, one_out);
          for (std::size_t i = 0; i < one_out.size(); ++i) {
            ASSERT_EQ(out[i * stride + robot], one_out[i]) << "robot " << robot << " of " << robots;
          }
        }
        EXPECT_EQ(out.back(), 77) << "wrote beyond the robots";
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(EveryKernel, Batch, ::testing::ValuesIn(instruction_sets()));

}  // namespace
}  // namespace screed::nn
