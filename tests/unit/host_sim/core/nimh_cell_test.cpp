// The curve of a NiMH cell, there and back.
#include "host_sim/core/nimh_cell.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

TEST(NimhCell, HasTheVoltagesOfTheDataSheet) {
  EXPECT_EQ(nimh_cell_v(1.0), 1.4);
  EXPECT_EQ(nimh_cell_v(2.0), 1.4);
  EXPECT_DOUBLE_EQ(nimh_cell_v(0.5), 1.25);
  EXPECT_DOUBLE_EQ(nimh_cell_v(0.0), 1.0);
  EXPECT_NEAR(nimh_cell_v(-0.025), 0.5, 1e-12);
  EXPECT_EQ(nimh_cell_v(-0.05), 0.0);
  EXPECT_EQ(nimh_cell_v(-1.0), 0.0);
}

TEST(NimhCell, ChargeAndVoltageAreEachOthersInverse) {
  for (int i = 0; i <= 1000; ++i)
    EXPECT_NEAR(nimh_charge(nimh_cell_v(0.001 * i)), 0.001 * i, 1e-12) << i;
  EXPECT_EQ(nimh_charge(0.5), 0.0);
  EXPECT_EQ(nimh_charge(1.6), 1.0);
}

}  // namespace
}  // namespace screed
