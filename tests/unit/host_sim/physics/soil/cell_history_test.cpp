// How a cell divides its plastic sinkage between what a body covers and the rest.
#include "host_sim/physics/soil/cell_history.h"

#include <gtest/gtest.h>

#include "host_sim/core/random.h"

namespace screed {
namespace {

constexpr double kSunk_m = 0.004;
constexpr double kTolerance_m = 1e-9;  // of the floats it keeps, a ten-millionth of the sinkage

/// A cell on which a body has stood in the last step, having covered `covered` from the start.
CellHistory pressed(double covered, double sunk) {
  CellHistory history;
  history.keep(covered, history.divide(covered, sunk, 1));
  history.touch(1);
  return history;
}

TEST(CellHistory, ABodyOnFreshSoilFindsNothingPressed) {
  const SinkageDivision part = CellHistory{}.divide(0.4, 0.0, 1);
  EXPECT_EQ(part.old_sinkage, 0.0);
  EXPECT_EQ(part.beside, 0.0);
  EXPECT_EQ(part.under(0.4, 0.0), 0.0);
}

TEST(CellHistory, WhatIsPressedInAContactIsUnderTheBody) {
  const CellHistory history = pressed(0.25, 0.0);
  // It has sunk since, the coverage is the same.
  const SinkageDivision part = history.divide(0.25, kSunk_m, 2);
  EXPECT_EQ(part.old_sinkage, 0.0);
  EXPECT_EQ(part.beside, 0.0);
  EXPECT_DOUBLE_EQ(part.under(0.25, kSunk_m), 4.0 * kSunk_m);
}

TEST(CellHistory, WhatABodyLeavesKeepsItsSinkage) {
  const CellHistory history = pressed(0.8, 0.0);
  const SinkageDivision part = history.divide(0.2, kSunk_m, 2);
  const double under = kSunk_m / 0.8;
  EXPECT_NEAR(part.under(0.2, kSunk_m), under, kTolerance_m);
  EXPECT_NEAR(part.beside, 0.6 * under, kTolerance_m);
  EXPECT_EQ(part.old_sinkage, 0.0);
}

TEST(CellHistory, WhatABodyReachesHasTheMeanOfTheRest) {
  CellHistory history = pressed(0.8, 0.0);
  history.keep(0.2, history.divide(0.2, kSunk_m, 2));
  history.touch(2);
  const double rest = 0.6 * kSunk_m / 0.8 / 0.8;  // 0.6 of the cell was left, in 0.8 of it
  const SinkageDivision part = history.divide(0.7, kSunk_m, 3);
  EXPECT_NEAR(part.beside, 0.3 * rest, kTolerance_m);
  EXPECT_NEAR(part.old_sinkage, 0.5 * rest / 0.7,
              kTolerance_m);  // of the part it had, nothing was old
  const SinkageDivision all = history.divide(1.0, kSunk_m, 3);
  EXPECT_NEAR(all.beside, 0.0, kTolerance_m);
  EXPECT_NEAR(all.under(1.0, kSunk_m), kSunk_m, kTolerance_m);
}

TEST(CellHistory, ANewContactFindsTheOldRutBelowIt) {
  CellHistory history = pressed(0.5, 0.0);
  history.keep(0.5, history.divide(0.5, kSunk_m, 2));
  history.touch(2);
  // Step 3 was without a body.
  for (const double covered : {0.5, 0.9}) {
    const SinkageDivision part = history.divide(covered, kSunk_m, 4);
    EXPECT_NEAR(part.old_sinkage, kSunk_m / covered, kTolerance_m) << covered;
    EXPECT_NEAR(part.beside, 0.0, kTolerance_m) << covered;
  }
  const SinkageDivision part = history.divide(0.1, kSunk_m, 4);
  EXPECT_NEAR(part.old_sinkage, kSunk_m / 0.5, kTolerance_m);
  EXPECT_NEAR(part.beside, 0.8 * kSunk_m, kTolerance_m);
}

TEST(CellHistory, AContactGoesOnFromStepToStepUntilItIsReleased) {
  CellHistory history;
  EXPECT_TRUE(history.is_contact_new(1));
  history.touch(7);
  EXPECT_FALSE(history.is_contact_new(7));
  EXPECT_FALSE(history.is_contact_new(8));
  EXPECT_TRUE(history.is_contact_new(9));
  history.release();
  EXPECT_TRUE(history.is_contact_new(8));
}

// A body that covers more and less of a cell, and does not sink: parts stay parts of one sum, none
// becomes negative, and what was there before the contact is all that is there.
TEST(CellHistory, DividingNeitherMakesNorLosesSinkage) {
  WorldRandom random(3, "coverage");
  for (int run = 0; run < 50; ++run) {
    CellHistory history;
    history.keep(0.6, {kSunk_m / 0.6, 0.0});  // a rut over six tenths, made by another body
    for (uint32_t step = 3; step < 40; ++step) {
      const double covered = random.uniform(0.05, 1.0);
      const SinkageDivision part = history.divide(covered, kSunk_m, step);
      ASSERT_NEAR(covered * part.old_sinkage + part.beside, kSunk_m, kTolerance_m) << step;
      ASSERT_NEAR(part.old_sinkage, part.under(covered, kSunk_m), kTolerance_m / 0.05) << step;
      ASSERT_GE(part.beside, -kTolerance_m) << step;
      ASSERT_LE(part.beside, kSunk_m + kTolerance_m) << step;
      history.keep(covered, part);
      history.touch(step);
    }
  }
}

}  // namespace
}  // namespace screed
