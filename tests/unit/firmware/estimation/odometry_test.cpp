// Dead reckoning on paths whose end is known.
#include "firmware/estimation/odometry.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/math/units.h"

namespace screed {
namespace {

constexpr uint16_t kCount_um_q4 = 9048;
constexpr double kCount_mm = 9048.0 / 16000.0;

TEST(Odometry, StraightOnInEveryDirection) {
  for (const int degrees : {0, 45, 90, 135, 180, -60}) {
    Odometry odometry(kCount_um_q4);
    const auto heading = wrap_angle(degrees * 65536 / 360);
    for (int tick = 0; tick < 1000; ++tick) odometry.update(3, 3, heading, 0);
    const double length = 3000 * kCount_mm;
    EXPECT_NEAR(odometry.x_mm(), length * std::cos(degrees * std::numbers::pi / 180.0), 1.5);
    EXPECT_NEAR(odometry.y_mm(), length * std::sin(degrees * std::numbers::pi / 180.0), 1.5);
  }
}

TEST(Odometry, BackwardsIsTheOppositeDistance) {
  Odometry odometry(kCount_um_q4);
  for (int tick = 0; tick < 500; ++tick) odometry.update(2, 2, 0, 0);
  for (int tick = 0; tick < 500; ++tick) odometry.update(-2, -2, 0, 0);
  EXPECT_EQ(odometry.x_mm(), 0);
  EXPECT_EQ(odometry.y_mm(), 0);
}

TEST(Odometry, ASquareCloses) {
  Odometry odometry(kCount_um_q4);
  for (int side = 0; side < 4; ++side) {
    for (int tick = 0; tick < 800; ++tick) odometry.update(2, 2, wrap_angle(side * 16384), 0);
    // Turns on the spot: the tracks run against each other and cover no distance.
    for (int tick = 0; tick < 100; ++tick)
      odometry.update(-3, 3, wrap_angle(side * 16384 + tick * 163), 0);
  }
  EXPECT_NEAR(odometry.x_mm(), 0, 1);
  EXPECT_NEAR(odometry.y_mm(), 0, 1);
}

TEST(Odometry, ACircleHasItsDiameterAndCloses) {
  // Heading of the middle of each tick, so that the polygon closes exactly; 3000 ticks of 5 counts
  // on both tracks.
  constexpr int kTicks = 3000;
  Odometry odometry(kCount_um_q4);
  int32_t north_most = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    odometry.update(2, 3, wrap_angle(static_cast<int32_t>((tick + 0.5) * 65536.0 / kTicks)), 0);
    north_most = std::max(north_most, odometry.y_mm());
  }
  EXPECT_NEAR(odometry.x_mm(), 0, 2);
  EXPECT_NEAR(odometry.y_mm(), 0, 2);
  EXPECT_NEAR(north_most, kTicks * 2.5 * kCount_mm / std::numbers::pi, 2.0);
}

TEST(Odometry, OnASlopeOnlyTheHorizontalPartCounts) {
  for (const int pitch_deg : {-30, 30, 60}) {
    Odometry odometry(kCount_um_q4);
    for (int tick = 0; tick < 1000; ++tick)
      odometry.update(2, 2, 0, wrap_angle(pitch_deg * 65536 / 360));
    EXPECT_NEAR(odometry.x_mm(), 2000 * kCount_mm * std::cos(pitch_deg * std::numbers::pi / 180.0),
                1.0);
  }
}

TEST(Odometry, HalfCountsAreNotLost) {
  // One track alone: half a count of travel a tick.
  Odometry odometry(kCount_um_q4);
  for (int tick = 0; tick < 10000; ++tick) odometry.update(tick % 2 == 0 ? 1 : 0, 0, 0, 0);
  EXPECT_NEAR(odometry.x_mm(), 2500 * kCount_mm, 0.001 * 2500 * kCount_mm);
}

TEST(Odometry, NoiseOfAnEncoderMovesNoFurtherThanOneTickCan) {
  Odometry odometry(kCount_um_q4);
  odometry.update(INT16_MAX, INT16_MAX, 0, 0);
  EXPECT_LE(odometry.x_mm(), 57);
  odometry.update(INT16_MIN, INT16_MIN, 0, 0);
  EXPECT_NEAR(odometry.x_mm(), 0, 1);
}

TEST(Odometry, StopsAtTheEndOfItsRange) {
  Odometry odometry(kCount_um_q4);
  for (int tick = 0; tick < 80000; ++tick) odometry.update(-100, -100, 0, 0);
  EXPECT_EQ(odometry.x_mm(), -2147483);
  odometry.reset();
  EXPECT_EQ(odometry.x_mm(), 0);
}

TEST(Odometry, TravelOfATickIsRoundedToAMicrometre) {
  // 16 counts of a sixteenth of a millimetre: each is 62.5 um, rounded to 63.
  Odometry odometry(1000);
  for (int count = 1; count <= 64; ++count) {
    odometry.update(1, 1, 16384, 0);
    // The sine of a quarter turn is 32767 / 32768: 62.998 um, rounded to 63.
    EXPECT_EQ(odometry.y_mm(), count * 63 / 1000) << count;
  }
}

TEST(Odometry, TakesAsManyCountsAsATickCanHold) {
  Odometry odometry(16000);  // a count is a millimetre
  odometry.update(100, 100, 0, 0);
  // The cosine of 0 is 32767 / 32768, twice: 6 um are missing.
  EXPECT_EQ(odometry.x_mm(), 99);
  odometry.update(101, 2000, 0, 0);
  EXPECT_EQ(odometry.x_mm(), 199);
  odometry.update(-100, -101, 0, 0);
  EXPECT_EQ(odometry.x_mm(), 99);
}

TEST(Odometry, AResetForgetsThePositionToTheLastPart) {
  Odometry odometry(1000);
  for (int count = 0; count < 47; ++count) odometry.update(1, 1, 8192, 0);  // 2.961 mm
  odometry.reset();
  EXPECT_EQ(odometry.x_mm(), 0);
  EXPECT_EQ(odometry.y_mm(), 0);
  for (int count = 0; count < 15; ++count) odometry.update(1, 1, 0, 0);  // 0.945 mm
  EXPECT_EQ(odometry.x_mm(), 0);
  odometry.update(1, 1, 0, 0);
  EXPECT_EQ(odometry.x_mm(), 1);
  EXPECT_EQ(odometry.y_mm(), 0);
}

}  // namespace
}  // namespace screed
