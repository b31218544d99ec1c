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

TEST(ChangeText, SaysWhetherItIsBetter) {
  EXPECT_EQ(change_text(20.0, 13.0), "-35.0 % better");
  EXPECT_EQ(change_text(20.0, 21.0), "+5.0 % worse");
  EXPECT_EQ(change_text(20.0, 20.001), "");
  EXPECT_EQ(change_text(0.0, 0.0), "");
  EXPECT_EQ(change_text(0.0, 1.0), "worse");
  EXPECT_EQ(share_change_text(0.25, 0.5), "+25.0 points better");
  EXPECT_EQ(share_change_text(0.5, 0.498), "-0.2 points worse");
  EXPECT_EQ(share_change_text(0.5, 0.5), "");
}

}  // namespace
}  // namespace screed
