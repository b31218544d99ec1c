// Dead reckoning on paths whose end is known.
#include "firmware/estimation/position_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "firmware/math/units.h"

namespace screed {
namespace {

constexpr uint16_t kCount_um_q4 = 9048;
constexpr double kCount_mm = 9048.0 / 16000.0;

TEST(PositionEstimate, StraightOnInEveryDirection) {
  for (const int degrees : {0, 45, 90, 135, 180, -60}) {
    PositionEstimate position(kCount_um_q4, 0, 255);
    const auto heading = wrap_angle(degrees * 65536 / 360);
    for (int tick = 0; tick < 1000; ++tick) position.update(3, 3, heading, 0, 255);
    const double length = 3000 * kCount_mm;
    EXPECT_NEAR(position.x_mm(), length * std::cos(degrees * std::numbers::pi / 180.0), 1.5);
    EXPECT_NEAR(position.y_mm(), length * std::sin(degrees * std::numbers::pi / 180.0), 1.5);
  }
}

TEST(PositionEstimate, BackwardsIsTheOppositeDistance) {
  PositionEstimate position(kCount_um_q4, 0, 255);
  for (int tick = 0; tick < 500; ++tick) position.update(2, 2, 0, 0, 255);
  for (int tick = 0; tick < 500; ++tick) position.update(-2, -2, 0, 0, 255);
  EXPECT_EQ(position.x_mm(), 0, 255);
  EXPECT_EQ(position.y_mm(), 0, 255);
}

TEST(PositionEstimate, ASquareCloses) {
  PositionEstimate position(kCount_um_q4, 0, 255);
  for (int side = 0; side < 4; ++side) {
    for (int tick = 0; tick < 800; ++tick) position.update(2, 2, wrap_angle(side * 16384), 0, 255);
    // Turns on the spot: the tracks run against each other and cover no distance.
    for (int tick = 0; tick < 100; ++tick)
      position.update(-3, 3, wrap_angle(side * 16384 + tick * 163), 0, 255);
  }
  EXPECT_NEAR(position.x_mm(), 0, 1);
  EXPECT_NEAR(position.y_mm(), 0, 1);
}

TEST(PositionEstimate, ACircleHasItsDiameterAndCloses) {
  // Heading of the middle of each tick, so that the polygon closes exactly; 3000 ticks of 5 counts
  // on both tracks.
  constexpr int kTicks = 3000;
  PositionEstimate position(kCount_um_q4, 0, 255);
  int32_t north_most = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    position.update(2, 3, wrap_angle(static_cast<int32_t>((tick + 0.5) * 65536.0 / kTicks)), 0,
                    255);
    north_most = std::max(north_most, position.y_mm());
  }
  EXPECT_NEAR(position.x_mm(), 0, 2);
  EXPECT_NEAR(position.y_mm(), 0, 2);
  EXPECT_NEAR(north_most, kTicks * 2.5 * kCount_mm / std::numbers::pi, 2.0);
}

TEST(PositionEstimate, OnASlopeOnlyTheHorizontalPartCounts) {
  for (const int pitch_deg : {-30, 30, 60}) {
    PositionEstimate position(kCount_um_q4, 0, 255);
    for (int tick = 0; tick < 1000; ++tick)
      position.update(2, 2, 0, wrap_angle(pitch_deg * 65536 / 360));
    EXPECT_NEAR(position.x_mm(), 2000 * kCount_mm * std::cos(pitch_deg * std::numbers::pi / 180.0),
                1.0);
  }
}

TEST(PositionEstimate, HalfCountsAreNotLost) {
  // One track alone: half a count of travel a tick.
  PositionEstimate position(kCount_um_q4, 0, 255);
  for (int tick = 0; tick < 10000; ++tick) position.update(tick % 2 == 0 ? 1 : 0, 0, 0, 0, 255);
  EXPECT_NEAR(position.x_mm(), 2500 * kCount_mm, 0.001 * 2500 * kCount_mm);
}

TEST(PositionEstimate, NoiseOfAnEncoderMovesNoFurtherThanOneTickCan) {
  PositionEstimate position(kCount_um_q4, 0, 255);
  position.update(INT16_MAX, INT16_MAX, 0, 0, 255);
  EXPECT_LE(position.x_mm(), 57);
  position.update(INT16_MIN, INT16_MIN, 0, 0, 255);
  EXPECT_NEAR(position.x_mm(), 0, 1);
}

TEST(PositionEstimate, StopsAtTheEndOfItsRange) {
  PositionEstimate position(kCount_um_q4, 0, 255);
  for (int tick = 0; tick < 80000; ++tick) position.update(-100, -100, 0, 0, 255);
  EXPECT_EQ(position.x_mm(), -2147483);
  position.reset();
  EXPECT_EQ(position.x_mm(), 0, 255);
}

TEST(PositionEstimate, TravelOfATickIsRoundedToAMicrometre) {
  // 16 counts of a sixteenth of a millimetre: each is 62.5 um, rounded to 63.
  PositionEstimate position(1000);
  for (int count = 1; count <= 64; ++count) {
    position.update(1, 1, 16384, 0, 255);
    // The sine of a quarter turn is 32767 / 32768: 62.998 um, rounded to 63.
    EXPECT_EQ(position.y_mm(), count * 63 / 1000) << count;
  }
}

TEST(PositionEstimate, TakesAsManyCountsAsATickCanHold) {
  PositionEstimate position(16000);  // a count is a millimetre
  position.update(100, 100, 0, 0, 255);
  // The cosine of 0 is 32767 / 32768, twice: 6 um are missing.
  EXPECT_EQ(position.x_mm(), 99);
  position.update(101, 2000, 0, 0, 255);
  EXPECT_EQ(position.x_mm(), 199);
  position.update(-100, -101, 0, 0, 255);
  EXPECT_EQ(position.x_mm(), 99);
}

TEST(PositionEstimate, AResetForgetsThePositionToTheLastPart) {
  PositionEstimate position(1000);
  for (int count = 0; count < 47; ++count) position.update(1, 1, 8192, 0);  // 2.961 mm
  position.reset();
  EXPECT_EQ(position.x_mm(), 0, 255);
  EXPECT_EQ(position.y_mm(), 0, 255);
  for (int count = 0; count < 15; ++count) position.update(1, 1, 0, 0);  // 0.945 mm
  EXPECT_EQ(position.x_mm(), 0, 255);
  position.update(1, 1, 0, 0, 255);
  EXPECT_EQ(position.x_mm(), 1);
  EXPECT_EQ(position.y_mm(), 0, 255);
}

}  // namespace
}  // namespace screed
