// Confidence intervals against published tables and another program.
#include "host_sim/core/intervals.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

TEST(Intervals, WilsonsIsThatOfTheTables) {
  // Newcombe, Statistics in Medicine 17 (1998), table I, method 3.
  EXPECT_NEAR(wilson(81, 263).low, 0.2553, 5e-5);
  EXPECT_NEAR(wilson(81, 263).high, 0.3662, 5e-5);
  EXPECT_NEAR(wilson(15, 148).low, 0.0624, 5e-5);
  EXPECT_NEAR(wilson(15, 148).high, 0.1605, 5e-5);
  EXPECT_NEAR(wilson(0, 20).low, 0.0, 1e-12);
  EXPECT_NEAR(wilson(0, 20).high, 0.1611, 5e-5);
  EXPECT_EQ(wilson(0, 0).low, 0.0);
  EXPECT_EQ(wilson(0, 0).high, 1.0);
}

TEST(Intervals, PoissonsIsGarwoods) {
  // Exact limits: 0 (0 to 3.689), 3 (0.619 to 8.767), 10 (4.795 to 18.39).
  EXPECT_EQ(poisson(0).low, 0.0);
  EXPECT_NEAR(poisson(0).high, 3.689, 0.025);
  EXPECT_NEAR(poisson(3).low, 0.619, 0.025);
  EXPECT_NEAR(poisson(3).high, 8.767, 0.025);
  EXPECT_NEAR(poisson(10).low, 4.795, 0.025);
  EXPECT_NEAR(poisson(10).high, 18.39, 0.025);
}

// E. B. Wilson, J. Am. Stat. Assoc. 22, 1927; values by R's binom::binom.wilson.
TEST(Intervals, WilsonsAgreesWithAnotherProgram) {
  const Interval half = wilson(5, 10);
  EXPECT_NEAR(half.low, 0.2366, 1e-4);
  EXPECT_NEAR(half.high, 0.7634, 1e-4);
  const Interval none = wilson(0, 10);
  EXPECT_NEAR(none.low, 0.0, 1e-12);
  EXPECT_NEAR(none.high, 0.2775, 1e-4);
  const Interval all = wilson(10, 10);
  EXPECT_NEAR(all.low, 0.7225, 1e-4);
  EXPECT_NEAR(all.high, 1.0, 1e-12);
}

}  // namespace
}  // namespace screed
