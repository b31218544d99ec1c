// The host's side of the HAL: the main loop on a target, nested, in several threads, with an error
// on the way.
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "boards/a_star_32u4/board.h"
#include "firmware/main_loop.h"
#include "firmware/robot/robot.h"
#include "hal/hal.h"
#include "hal/host/target.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {
namespace {

void run_firmware(hal::Target& target) {
  const hal::TargetScope scope(target);
  main_loop();
}

/// Counts calls, feeds level samples, keeps what comes back.
class FakeTarget : public hal::Target {
 public:
  explicit FakeTarget(int ticks, int16_t seed = 1) : ticks_(ticks) {
    parameters_.random_seed() = seed;
  }

  void init() override { calls += 'i'; }
  const BoardConstants& board_constants() override {
    calls += 'b';
    return kBoard;
  }
  const Parameters& parameters() override {
    calls += 'p';
    return parameters_;
  }
  const Credentials& credentials() override {
    calls += 'c';
    return credentials_;
  }
  bool wait_for_tick() override {
    calls += 'w';
    if (fail_at == tick_) throw std::runtime_error("the world ended");
    return tick_++ < ticks_;
  }
  void read_sensors(SensorSample& sample) override {
    calls += 'r';
    sample.imu.accel()[2] = 4098;
    sample.imu.gyro()[0] = static_cast<int16_t>(tick_ % 2);
    sample.fresh = kFreshGyro | kFreshAccel;
  }
  void write_outputs(const RobotOutput& output) override {
    calls += 'o';
    outputs.insert(outputs.end(), output.radio_out, output.radio_out + output.radio_out_count);
    if (inner != nullptr) run_firmware(*inner);
  }

  std::string calls;
  std::vector<uint8_t> outputs;
  FakeTarget* inner = nullptr;
  int fail_at = -1;

 private:
  Parameters parameters_;
  Credentials credentials_ = credentials_of(test_key());
  int ticks_;
  int tick_ = 0;
};

TEST(HostHal, TheMainLoopCallsInOrder) {
  FakeTarget target(2);
  run_firmware(target);
  // The order in which board and parameters are asked for is the compiler's.
  EXPECT_EQ(target.calls.substr(0, 1), "i");
  EXPECT_EQ(target.calls.substr(4), "wrowrow");
}

TEST(HostHal, WhatTheRobotSaysReachesTheTarget) {
  FakeTarget target(50);
  run_firmware(target);
  Robot robot(kBoard, Parameters{}, credentials_of(test_key()));
  FakeTarget samples(50);
  std::vector<uint8_t> expected;
  SensorSample sample{};
  RobotOutput output{};
  while (samples.wait_for_tick()) {
    samples.read_sensors(sample);
    robot.tick(sample, output);
    expected.insert(expected.end(), output.radio_out, output.radio_out + output.radio_out_count);
  }
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(target.outputs, expected);
}

TEST(HostHal, ATargetMayRunAnotherAndGoesOnAfterwards) {
  FakeTarget inner(1);
  FakeTarget outer(3);
  outer.inner = &inner;
  run_firmware(outer);
  EXPECT_EQ(outer.calls.substr(4), "wrowrowrow");
  EXPECT_EQ(inner.calls.substr(0, 1), "i");
}

TEST(HostHal, AnErrorOfTheTargetPassesThroughAndLeavesTheThreadUsable) {
  FakeTarget failing(10);
  failing.fail_at = 4;
  FakeTarget outer(2);
  outer.inner = &failing;
  EXPECT_THROW(run_firmware(outer), std::runtime_error);
  FakeTarget next(5);
  EXPECT_NO_THROW(run_firmware(next));
  EXPECT_EQ(next.calls.size(), 4U + 5U * 3U + 1U);
}

TEST(HostHal, ThreadsHaveARobotEach) {
  FakeTarget alone(300);
  run_firmware(alone);
  std::vector<FakeTarget> targets(4, FakeTarget(300));
  std::vector<std::thread> threads;
  threads.reserve(targets.size());
  for (FakeTarget& target : targets) threads.emplace_back([&target] { run_firmware(target); });
  for (std::thread& thread : threads) thread.join();
  for (const FakeTarget& target : targets) EXPECT_EQ(target.outputs, alone.outputs);
}

}  // namespace
}  // namespace screed
