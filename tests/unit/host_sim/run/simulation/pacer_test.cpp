// Pacing by a clock that only moves when told to.
#include "host_sim/run/simulation/run_loop.h"

#include <gtest/gtest.h>

#include <vector>

namespace screed {
namespace {

using namespace std::chrono_literals;

class FakeClock : public WallClock {
 public:
  Time now() const override { return time; }
  void sleep_until(Time until) override {
    slept_to.push_back(until);
    time = std::max(time, until);
  }

  Time time{1000s};
  std::vector<Time> slept_to;
};

TEST(Pacer, SleepsUntilTheClockHasCaughtUp) {
  FakeClock clock;
  Pacer pacer(clock, true);
  pacer.wait_until(0.01);
  pacer.wait_until(0.02);
  ASSERT_EQ(clock.slept_to.size(), 2U);
  EXPECT_EQ(clock.slept_to[0] - FakeClock::Time(1000s), 10ms);
  EXPECT_EQ(clock.slept_to[1] - FakeClock::Time(1000s), 20ms);
  EXPECT_DOUBLE_EQ(pacer.elapsed_s(), 0.02);
}

TEST(Pacer, ALateRunIsNotPacedByItsDelay) {
  FakeClock clock;
  Pacer pacer(clock, true);
  clock.time += 3s;
  pacer.wait_until(1.0);
  EXPECT_DOUBLE_EQ(pacer.elapsed_s(), 3.0);
  pacer.wait_until(3.5);
  EXPECT_DOUBLE_EQ(pacer.elapsed_s(), 3.5);
}

TEST(Pacer, NeverSleepsWithoutRealtime) {
  FakeClock clock;
  Pacer pacer(clock, false);
  pacer.wait_until(5.0);
  EXPECT_TRUE(clock.slept_to.empty());
  clock.time += 250ms;
  EXPECT_DOUBLE_EQ(pacer.elapsed_s(), 0.25);
}

}  // namespace
}  // namespace screed
