// Quantiles of small samples, by hand.
#include "host_sim/core/quantile.h"

#include <gtest/gtest.h>

#include <cmath>

namespace screed {
namespace {

TEST(Quantile, IsTheOrderStatisticWhereTheShareMeetsOne) {
  const std::vector<double> values = {30.0, 10.0, 50.0, 20.0, 40.0};
  EXPECT_EQ(quantile(values, 0.0), 10.0);
  EXPECT_EQ(quantile(values, 0.25), 20.0);
  EXPECT_EQ(quantile(values, 0.5), 30.0);
  EXPECT_EQ(quantile(values, 0.75), 40.0);
  EXPECT_EQ(quantile(values, 1.0), 50.0);
}

TEST(Quantile, InterpolatesLinearlyInBetween) {
  EXPECT_DOUBLE_EQ(quantile({0.0, 10.0}, 0.8), 8.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 4.0, 8.0}, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 4.0, 8.0}, 0.9), 6.8);
}

TEST(Quantile, OfOneValueIsThatValueAndOfNoneNothing) {
  for (const double share : {0.0, 0.3, 1.0}) EXPECT_EQ(quantile({7.0}, share), 7.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace screed
