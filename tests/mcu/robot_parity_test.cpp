// Robot::tick gives the same bytes on the MCU and on the host, for the same samples: a scripted
// mission of 25 s with commands over the radio, driving, hills, garbage on the line, a tilt fault
// and lost sensors.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "board.h"
#include "firmware/robot/robot.h"
#include "host_sim/devices/mcu/mcu.h"
#include "tests/mcu/golden_vectors.h"
#include "tests/mcu/images.h"
#include "tests/mcu/mission.h"
#include "tests/mcu/sample_wire.h"
#include "tests/mcu/test_credentials.h"

namespace screed::mcu {
namespace {

struct Bytes {
  std::vector<std::uint8_t> bytes;
  void put(std::uint8_t byte) { bytes.push_back(byte); }
};

TEST(RobotParity, McuAgreesWithHostForEveryTickOfAMission) {
  const Parameters parameters;
  Robot robot(kBoard, parameters, kTestCredentials);
  Mission mission;
  Mcu mcu(kRobotImage);
  mcu.run_ms(1);

  std::size_t sent = 0;
  int driving_ticks = 0;
  bool faulted = false;
  for (int tick = 0; tick < Mission::kTicks; ++tick) {
    const SensorSample sample = mission.next();
    Bytes to_mcu;
    put_sample(to_mcu, sample);
    mcu.receive(to_mcu.bytes);

    RobotOutput output{};
    robot.tick(sample, output);
    Bytes expected;
    put_output(expected, output);
    mcu.run_until_sent(sent + expected.bytes.size(), 1000);
    const std::vector<std::uint8_t> actual(mcu.sent().begin() + static_cast<std::ptrdiff_t>(sent),
                                           mcu.sent().end());
    ASSERT_EQ(actual, expected.bytes) << "tick " << tick;
    sent = mcu.sent().size();
    if (output.duty_left != 0) ++driving_ticks;
    faulted = faulted || robot.supervisor().state() == RobotState::kFault;
  }
  // The mission is worth the comparison: the robot drove, and met a fault.
  EXPECT_GT(driving_ticks, 800);
  EXPECT_TRUE(faulted);
  EXPECT_EQ(robot.parameters().walk_speed_max(), Mission::kWalkSpeedMax);
  EXPECT_EQ(robot.parameters().accel_limit(), Mission::kAccelLimit);
  EXPECT_EQ(robot.parameters().climb_threshold(), Mission::kClimbThreshold);
}

}  // namespace
}  // namespace screed::mcu
