// Standardised inputs, and a layer brought back to the inputs as they are.
#include "nn/training/input_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace screed::nn {
namespace {

const Examples kExamples = {2, 1, {1.0F, 10.0F, 3.0F, 10.0F, 8.0F, 10.0F}, {0.0F, 0.0F, 0.0F}};

TEST(InputStatistics, MeanAndDeviationOfThePopulation) {
  const InputStatistics statistics(kExamples);
  ASSERT_EQ(statistics.mean().size(), 2U);
  EXPECT_DOUBLE_EQ(statistics.mean()[0], 4.0);
  EXPECT_DOUBLE_EQ(statistics.mean()[1], 10.0);
  EXPECT_DOUBLE_EQ(statistics.deviation()[0], std::sqrt((9.0 + 1.0 + 16.0) / 3.0));
  EXPECT_DOUBLE_EQ(statistics.deviation()[1], 1e-6) << "one that never changes";
}

TEST(InputStatistics, StandardisedInputsHaveMeanNoughtAndDeviationOne) {
  const InputStatistics statistics(kExamples);
  const Examples standardised = statistics.standardised(kExamples);
  const InputStatistics of_them(standardised);
  EXPECT_NEAR(of_them.mean()[0], 0.0, 1e-6);
  EXPECT_NEAR(of_them.deviation()[0], 1.0, 1e-6);
  EXPECT_NEAR(standardised.in[1], 0.0, 1e-6);
  EXPECT_LT(standardised.in[0], 0.0F) << "the least one";
}

TEST(InputStatistics, AFoldedLayerGivesOfTheInputsWhatItGaveOfTheStandardisedOnes) {
  Examples examples{3, 1, {}, {}};
  for (int i = 0; i < 60; ++i) {
    examples.in.push_back(static_cast<float>(std::sin(1.7 * i) * (1 + i % 3) + 0.5 * (i % 3)));
  }
  const InputStatistics statistics(examples);
  const FloatLayer learned = {3, 2, true, {0.3, -1.2, 0.7, 2.0, 0.1, -0.4}, {0.25, -0.5}};
  FloatLayer folded = learned;
  statistics.fold_into(folded);
  const Examples standardised = statistics.standardised(examples);
  for (std::size_t row = 0; row < examples.rows(); ++row) {
    for (std::size_t node = 0; node < 2; ++node) {
      double before = learned.bias[node];
      double after = folded.bias[node];
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t at = row * 3 + i;
        before += learned.weights[node * 3 + i] * static_cast<double>(standardised.in[at]);
        after += folded.weights[node * 3 + i] * static_cast<double>(examples.in[at]);
      }
      EXPECT_NEAR(after, before, 1e-5) << row << " " << node;
    }
  }
}

}  // namespace
}  // namespace screed::nn
