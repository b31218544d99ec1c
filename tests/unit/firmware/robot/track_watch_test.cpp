// The supervisor's witnesses of a track that does not move and of chips that fail.
#include <gtest/gtest.h>

#include <initializer_list>

#include "firmware/robot/supervisor.h"

namespace screed {
namespace {

TEST(TrackWatch, CountsStepToAndFroWithABrokenWire) {
  for (const int16_t duty : std::initializer_list<int16_t>{60, 240, -60, -400}) {
    TrackWatch watch;
    int ticks = 0;
    while (!watch.alternates() && ticks < 100) {
      watch.tick(duty, static_cast<int16_t>(ticks % 2 == 0 ? 1 : -1));
      ++ticks;
    }
    EXPECT_EQ(ticks, duty > 0 ? 5 : 4) << duty << ": forward the first step is progress";
  }
}

TEST(TrackWatch, BelowTheDutyOfAStallNothingIsCounted) {
  TrackWatch watch;
  for (int tick = 0; tick < 10; ++tick) watch.tick(109, 0);
  EXPECT_EQ(watch.still_ticks(), 0);
  for (int tick = 0; tick < 10; ++tick) watch.tick(110, 0);
  EXPECT_EQ(watch.still_ticks(), 10);
  watch.tick(-109, 0);
  EXPECT_EQ(watch.still_ticks(), 0);
}

TEST(TrackWatch, TwoCountsInATickAreProgressEitherWay) {
  for (const int16_t counts : std::initializer_list<int16_t>{2, -2, 3, -3, 40, -40}) {
    TrackWatch watch;
    for (int tick = 0; tick < 10; ++tick) watch.tick(300, 0);
    watch.tick(300, counts);
    EXPECT_EQ(watch.still_ticks(), 0) << counts;
  }
}

TEST(TrackWatch, TwoCountsInARowLeaveThePlaceOneDoesNotBackwards) {
  TrackWatch watch;
  for (int tick = 0; tick < 10; ++tick) watch.tick(300, 0);
  watch.tick(300, -1);
  EXPECT_EQ(watch.still_ticks(), 11) << "one count behind";
  watch.tick(300, -1);
  EXPECT_EQ(watch.still_ticks(), 0) << "two: it rolls back";
  watch.tick(300, -1);
  EXPECT_EQ(watch.still_ticks(), 1) << "the place is where it was seen last";
}

TEST(TrackWatch, StepsThatCancelWithinATickAreAStandstill) {
  TrackWatch watch;
  for (int tick = 0; tick < 18; ++tick) {
    const int16_t counts = tick == 0 || tick == 10 ? 1 : tick == 5 ? -1 : 0;
    watch.tick(300, counts);
  }
  EXPECT_EQ(watch.still_ticks(), 17) << "only the first step was progress";
}

TEST(TrackWatch, MotionEitherWayIsNeither) {
  for (const int16_t duty : std::initializer_list<int16_t>{60, 300, -300}) {
    for (const int16_t counts : std::initializer_list<int16_t>{1, 3, -1, -3}) {
      TrackWatch watch;
      for (int tick = 0; tick < 200; ++tick) {
        watch.tick(duty, tick % 4 == 0 ? counts : static_cast<int16_t>(0));
        EXPECT_FALSE(watch.alternates());
        EXPECT_LT(watch.still_ticks(), 18);
      }
    }
  }
}

TEST(TrackWatch, ATrackWithoutPowerMayRockAsItLikes) {
  TrackWatch watch;
  for (int tick = 0; tick < 200; ++tick)
    watch.tick(59, static_cast<int16_t>(tick % 2 == 0 ? 1 : -1));
  EXPECT_FALSE(watch.alternates());
  EXPECT_EQ(watch.still_ticks(), 0);
}

TEST(TrackWatch, GreatStepsDoNotOverflow) {
  TrackWatch watch;
  for (const int16_t counts : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX, INT16_MIN}) {
    watch.tick(-kDutyMax, counts);
    watch.tick(400, counts);
  }
  EXPECT_FALSE(watch.alternates());
}

TEST(TrackWatch, ATrackThatMovesAgainstItsDutyDisobeys) {
  constexpr uint16_t kFullSpeed_mm_per_s = 250;
  struct Motion {
    int16_t duty;
    int16_t speed_dmm_per_s;
    int ticks;  ///< until it disobeys; 0: never
  };
  for (const Motion& it : std::initializer_list<Motion>{{240, -501, 12},
                                                        {-240, 501, 12},
                                                        {400, -2500, 12},
                                                        {0, 1001, 24},
                                                        {0, -1001, 24},
                                                        {59, 1001, 24},
                                                        {-239, 1001, 24},
                                                        {60, 1001, 0},
                                                        {0, 1000, 0},
                                                        {240, -500, 0},
                                                        {400, INT16_MAX, 0},
                                                        {400, INT16_MIN, 12}}) {
    TrackWatch watch;
    int ticks = 0;
    while (!watch.disobeys() && ticks < 300) {
      watch.compare(it.duty, it.speed_dmm_per_s, kFullSpeed_mm_per_s);
      ++ticks;
    }
    EXPECT_EQ(ticks, it.ticks == 0 ? 300 : it.ticks) << it.duty << " " << it.speed_dmm_per_s;
    // One tick in order ends it.
    watch.compare(300, 0, kFullSpeed_mm_per_s);
    EXPECT_FALSE(watch.disobeys());
  }
}

/// A tick of a healthy robot with these chips failing.
void tick(Supervisor& supervisor, uint8_t chips_failing, int number) {
  const int16_t gyro[3] = {static_cast<int16_t>(number % 2), 0, 0};
  const int16_t accel[3] = {0, 0, 4098};
  SupervisorInput input{};
  input.fresh = kFreshGyro | kFreshAccel;
  input.gyro = gyro;
  input.accel = accel;
  input.cos_tilt_q14 = 16384;
  input.estimator_ready = true;
  input.attitude_known = true;
  input.battery_mv = 7200;
  input.chips_failing = chips_failing;
  supervisor.heartbeat();
  supervisor.tick(Parameters(), input);
}

TEST(SupervisorChips, AFailingChipStopsTheRobotAndIsNamed) {
  for (const uint8_t chip : {ChipBit::kAccelMagChip, ChipBit::kGyroChip}) {
    Supervisor supervisor;
    for (int i = 0; i < 10; ++i) tick(supervisor, 0, i);
    ASSERT_EQ(supervisor.request(Request::kArm), RequestResult::kDone);
    ASSERT_EQ(supervisor.request(Request::kRun), RequestResult::kDone);
    for (int i = 0; i < 4; ++i) tick(supervisor, chip, i);
    EXPECT_TRUE(supervisor.running()) << "a hitch of the bus is no fault";
    tick(supervisor, chip, 5);
    EXPECT_EQ(supervisor.state(), RobotState::kFault);
    EXPECT_EQ(supervisor.faults(), chip << 8);
    // Latched; cleared once the chip is back.
    EXPECT_EQ(supervisor.request(Request::kClear), RequestResult::kFaultPresent);
    tick(supervisor, 0, 6);
    EXPECT_EQ(supervisor.request(Request::kClear), RequestResult::kDone);
  }
}

TEST(SupervisorChips, ARobotWithAFailingChipIsNotArmed) {
  Supervisor supervisor;
  for (int i = 0; i < 10; ++i) tick(supervisor, ChipBit::kGyroChip, i);
  EXPECT_EQ(supervisor.request(Request::kArm), RequestResult::kFaultPresent);
  EXPECT_EQ(supervisor.faults(), 0) << "nothing latched in a robot that nobody armed";
  EXPECT_EQ(supervisor.reported_faults(), Fault::kGyroChip) << "but the ground is told why";
}

TEST(SupervisorChips, ARobotDrivesWithoutItsBarometer) {
  Supervisor supervisor;
  for (int i = 0; i < 10; ++i) tick(supervisor, ChipBit::kBaroChip, i);
  EXPECT_EQ(supervisor.reported_faults(), 0);
  EXPECT_EQ(supervisor.request(Request::kArm), RequestResult::kDone);
  EXPECT_EQ(supervisor.request(Request::kRun), RequestResult::kDone);
  for (int i = 0; i < 10; ++i) tick(supervisor, ChipBit::kBaroChip, i);
  EXPECT_TRUE(supervisor.running());
}

}  // namespace
}  // namespace screed
