// Trials of the escape: a robot digs itself in, and what gets it out.
// Long: two drives on soil, with the escape and without.
#include <gtest/gtest.h>

#include "nn/slip/escape_run.h"

namespace screed::nn {
namespace {

TEST(EscapeTrials, FromRutsItGetsOutWhereTheWalkAloneDoesNot) {
  const EscapeResult result = escape_trials(430007, {.oracle = false});
  ASSERT_EQ(result.scenario.experiment.trap.kind, "ruts");
  EXPECT_FALSE(result.backed_off);
  EXPECT_TRUE(result.stuck);
  EXPECT_FALSE(result.out_alone);
  EXPECT_TRUE(result.out_escape);
  EXPECT_TRUE(result.recoverable);
  EXPECT_GT(result.escape_s, 0.0);
  EXPECT_LE(result.escape_s, kEscapeTime_s);
}

}  // namespace
}  // namespace screed::nn
