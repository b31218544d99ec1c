// A shadow that agrees with the robot, and what is said when it does not.
#include "host_sim/run/simulation/parity.h"

#include <gtest/gtest.h>

#include "host_sim/core/errors.h"
#include "tests/unit/test_robot.h"

namespace screed {
namespace {

class ParityCheckerTest : public ::testing::Test {
 protected:
  /// One tick of both.
  void tick() {
    robot_.tick();
    checker_.tick(robot_.sample);
  }
  std::string complaint(const RobotOutput& answer) const {
    try {
      checker_.require_equal(answer);
    } catch (const RunError& error) {
      return error.what();
    }
    return "";
  }

  TestRobot robot_;
  ParityChecker checker_{RobotSettings{kBoard, Parameters{}, credentials_of(test_key())}};
};

TEST_F(ParityCheckerTest, TwoRobotsOnTheSameSamplesAgree) {
  robot_.send(robot_.command(CommandOp::kArm));
  for (int i = 0; i < 700; ++i) {
    tick();
    ASSERT_EQ(complaint(robot_.output), "");
    ASSERT_EQ(checker_.compare(robot_.output).bytes, 0U);
  }
  EXPECT_EQ(checker_.ticks(), 700U);
  EXPECT_EQ(checker_.shadow().attitude().pitch(), robot_.robot.attitude().pitch());
}

TEST_F(ParityCheckerTest, NamesTickAndFirstColumnThatDiffers) {
  for (int i = 0; i < 3; ++i) tick();
  RobotOutput answer = robot_.output;
  answer.duty_left = 17;
  answer.leds ^= kLedRed;
  EXPECT_EQ(complaint(answer),
            "two robots answered the same samples differently in tick 3: duty_left: expected 0, "
            "got 17");
  const ParityChecker::Difference difference = checker_.compare(answer);
  EXPECT_EQ(difference.bytes, 2U);
  EXPECT_EQ(difference.first, "duty_left: expected 0, got 17");
}

TEST_F(ParityCheckerTest, RadioBytesBehindTheValidOnesDoNotCount) {
  do {
    tick();
  } while (robot_.output.radio_out_count == 0);
  RobotOutput answer = robot_.output;
  ASSERT_LT(answer.radio_out_count, kRadioOutCapacity);
  answer.radio_out[answer.radio_out_count] ^= 0x55U;
  EXPECT_EQ(complaint(answer), "");
  answer.radio_out[0] ^= 0x01U;
  EXPECT_NE(complaint(answer).find("radio_out"), std::string::npos) << complaint(answer);
}

TEST_F(ParityCheckerTest, ARobotThatMissedASampleIsFound) {
  robot_.run(1);
  std::string said;
  for (int i = 0; i < 1000 && said.empty(); ++i) {
    tick();
    said = complaint(robot_.output);
  }
  EXPECT_NE(said, "");
}

}  // namespace
}  // namespace screed
