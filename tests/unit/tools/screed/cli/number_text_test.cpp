// Numbers as messages show them.
#include "tools/screed/cli/number_text.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

TEST(FactorText, HasTwoDigitsBelowTen) {
  EXPECT_EQ(factor_text(0.0), "0");
  EXPECT_EQ(factor_text(0.0343), "0.034");
  EXPECT_EQ(factor_text(0.4), "0.40");
  EXPECT_EQ(factor_text(0.0996), "0.10");
  EXPECT_EQ(factor_text(1.04), "1.0");
  EXPECT_EQ(factor_text(9.94), "9.9");
  EXPECT_EQ(factor_text(9.96), "10");
  EXPECT_EQ(factor_text(12.6), "13");
  EXPECT_EQ(factor_text(1234.4), "1234");
}

}  // namespace
}  // namespace screed
