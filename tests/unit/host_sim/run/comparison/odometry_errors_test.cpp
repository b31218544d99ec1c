// The summary of legs of dead reckoning, against published tables.
#include "host_sim/run/comparison/odometry_errors.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace screed {
namespace {

std::vector<OdometryLeg> legs_of(int count) {
  std::vector<OdometryLeg> legs;
  for (int i = 0; i < count; ++i) {
    OdometryLeg leg;
    leg.error_m = {0.01 * i, 0.02 * i, 0.03 * i};
    leg.normalized_squared = i % 2 == 0 ? 1.0 : 5.0;
    legs.push_back(leg);
  }
  return legs;
}

TEST(OdometryErrors, AreSummarizedByQuantiles) {
  const OdometrySummary summary = summarize(legs_of(101));
  EXPECT_EQ(summary.legs, 101U);
  EXPECT_NEAR(summary.errors[0].median_m, 0.50, 1e-12);
  EXPECT_NEAR(summary.errors[1].ninety_percent_m, 1.80, 1e-12);
  // Binomial, 101 values: the 41st and the 61st.
  EXPECT_NEAR(summary.errors[0].median_95_m.low, 0.40, 0.01);
  EXPECT_NEAR(summary.errors[2].median_95_m.high, 1.80, 0.03);
}

TEST(OdometryErrors, ConsistencyIsTheMeanSquareOverTheVariance) {
  // 51 times 1 and 50 times 5, over two degrees of freedom.
  EXPECT_NEAR(summarize(legs_of(101)).consistency, 301.0 / 202.0, 1e-12);
}

// Chi squared, 2.5 and 97.5 %: 9.591 and 34.170 of 20 degrees of freedom, 74.222 and 129.561 of
// 100.
TEST(OdometryErrors, ConsistentOnesLieBetweenTheQuantilesOfChiSquared) {
  EXPECT_NEAR(summarize(legs_of(10)).consistent.low, 9.591 / 20.0, 0.002);
  EXPECT_NEAR(summarize(legs_of(10)).consistent.high, 34.170 / 20.0, 0.002);
  EXPECT_NEAR(summarize(legs_of(50)).consistent.low, 0.74222, 0.0005);
  EXPECT_NEAR(summarize(legs_of(50)).consistent.high, 1.29561, 0.0005);
}

TEST(OdometryErrors, OfNoLegThereIsNoSummary) {
  EXPECT_THROW(summarize({}), std::invalid_argument);
}

}  // namespace
}  // namespace screed
