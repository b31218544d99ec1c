// Which ticks of a drive teach the slip watch, and what.
#include "nn/slip/slip_examples.h"

#include <gtest/gtest.h>

#include "nn/model/quantiser.h"

namespace screed::nn {
namespace {

/// A drive whose chassis makes this share of the tracks' travel; the first input counts the ticks.
SlipRun even_drive(std::size_t ticks, double share) {
  SlipRun run;
  for (std::size_t i = 0; i < ticks; ++i) {
    SlipTick tick{};
    tick.inputs[0] = static_cast<std::int16_t>(i);
    tick.inputs[1] = static_cast<std::int16_t>(-static_cast<int>(i));
    tick.running = true;
    tick.evaluated = true;
    tick.faster_track = 0.2F;
    tick.speed = static_cast<float>(0.2 * share);
    run.ticks.push_back(tick);
  }
  return run;
}

std::vector<std::size_t> ticks_of(const Examples& examples) {
  std::vector<std::size_t> ticks;
  for (std::size_t row = 0; row < examples.rows(); ++row) {
    for (std::size_t i = 0; i < 400; ++i) {
      const auto value = static_cast<float>(to_value(static_cast<std::int16_t>(i)));
      if (examples.in[row * kSlipInputs] == value) ticks.push_back(i);
    }
  }
  return ticks;
}

TEST(SlipExamples, AreEveryFourthTickWithFifteenAroundIt) {
  const Examples examples = slip_examples({even_drive(42, 1.0)});
  EXPECT_EQ(examples.inputs, kSlipInputs);
  EXPECT_EQ(examples.outputs, 1U);
  EXPECT_EQ(examples.out.size(), examples.rows());
  EXPECT_EQ(ticks_of(examples), (std::vector<std::size_t>{15, 19, 23}))
      << "27 has 14 ticks behind it";
  EXPECT_EQ(slip_examples({even_drive(43, 1.0)}).rows(), 4U);
  EXPECT_EQ(slip_examples({even_drive(30, 1.0)}).rows(), 0U);
  EXPECT_EQ(slip_examples({even_drive(31, 1.0), even_drive(31, 1.0)}).rows(), 2U);
  EXPECT_EQ(examples.in[1], static_cast<float>(to_value(-15)));
}

TEST(SlipExamples, HardlyMovingIsBelowAQuarterAndMovingAboveTwoFifths) {
  struct Case {
    double share;
    int label;  // -1: teaches nothing
  };
  for (const Case c : {Case{0.0, 1}, Case{0.24, 1}, Case{0.26, -1}, Case{0.31, -1}, Case{0.39, -1},
                       Case{0.41, 0}, Case{1.0, 0}}) {
    const Examples examples = slip_examples({even_drive(31, c.share)});
    ASSERT_EQ(examples.rows(), c.label < 0 ? 0U : 1U) << c.share;
    if (c.label >= 0) {
      EXPECT_EQ(examples.out[0], static_cast<float>(c.label)) << c.share;
    }
  }
}

TEST(SlipExamples, AreLabelledByTheMotionAroundThem) {
  // Dug in from tick 100 on: 15 ticks on either side decide.
  SlipRun run = even_drive(300, 1.0);
  for (std::size_t i = 100; i < 300; ++i) run.ticks[i].speed = 0.0F;
  const Examples examples = slip_examples({run});
  const std::vector<std::size_t> ticks = ticks_of(examples);
  for (std::size_t row = 0; row < ticks.size(); ++row) {
    // (100 - (i - 15)) / 30 of the travel is made.
    const double share = (115.0 - static_cast<double>(ticks[row])) / 30.0;
    EXPECT_EQ(examples.out[row], share < 0.25 ? 1.0F : 0.0F) << ticks[row];
    EXPECT_TRUE(share < 0.25 || share > 0.4) << ticks[row];
  }
  EXPECT_GT(ticks.size(), 60U);
}

TEST(SlipExamples, TicksThatTheWatchDoesNotEvaluateAreLeftOut) {
  SlipRun run = even_drive(46, 1.0);
  run.ticks[15].running = false;
  run.ticks[19].evaluated = false;
  EXPECT_EQ(ticks_of(slip_examples({run})), (std::vector<std::size_t>{23, 27}));
}

}  // namespace
}  // namespace screed::nn
