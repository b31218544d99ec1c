// Skid-steer kinematics against the formulas of thesis 5.1.2 in floating point.
#include "firmware/control/kinematics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>

namespace screed {
namespace {

constexpr uint16_t kTread_mm = 195;
constexpr int16_t kLimit_mm_per_s = 250;
constexpr int16_t kNoLimit = INT16_MAX;

double turn_speed(double tread_mm, double yaw_rate) {
  const double omega_rad_per_s = yaw_rate * 2.0 * std::numbers::pi / 65536.0;
  return tread_mm * omega_rad_per_s / 2.0;
}

TEST(Kinematics, FollowsTheThesisWithinHalfAMillimetreASecond) {
  for (const uint16_t tread_mm : std::initializer_list<uint16_t>{1, 50, 98, 195, 300}) {
    const SkidSteer kinematics(tread_mm);
    // The factor is short of 64 pi by 0.03 %.
    const double rounding = 0.5 + 0.00032 * turn_speed(tread_mm, 32767.0);
    for (int32_t rate = -32767; rate <= 32767; rate += 331) {
      for (const int16_t speed : std::initializer_list<int16_t>{-250, -31, 0, 1, 200}) {
        const TrackSpeeds tracks = kinematics.tracks(speed, rate, kNoLimit);
        ASSERT_NEAR(tracks.left, speed - turn_speed(tread_mm, rate), rounding) << rate;
        ASSERT_NEAR(tracks.right, speed + turn_speed(tread_mm, rate), rounding) << rate;
      }
    }
  }
}

TEST(Kinematics, RoundsWithoutBiasToOneSide) {
  const SkidSteer kinematics(kTread_mm);
  int32_t sum = 0;
  for (int32_t rate = -20000; rate <= 20000; ++rate) {
    const TrackSpeeds tracks = kinematics.tracks(0, rate, kNoLimit);
    sum += tracks.right;
  }
  EXPECT_NEAR(sum / 40001.0, 0.0, 0.01);
  EXPECT_EQ(kinematics.tracks(100, -1, kLimit_mm_per_s).left, 100);
}

TEST(Kinematics, TurnIsKeptWhenTheTracksSaturate) {
  const SkidSteer kinematics(kTread_mm);
  for (int32_t rate = -32767; rate <= 32767; rate += 97) {
    for (int32_t speed = INT16_MIN; speed <= INT16_MAX; speed += 1021) {
      const TrackSpeeds tracks =
          kinematics.tracks(static_cast<int16_t>(speed), rate, kLimit_mm_per_s);
      ASSERT_LE(std::abs(tracks.left), kLimit_mm_per_s);
      ASSERT_LE(std::abs(tracks.right), kLimit_mm_per_s);
      const double wanted = turn_speed(kTread_mm, rate);
      const double turn = (tracks.right - tracks.left) / 2.0;
      ASSERT_NEAR(turn, std::clamp(wanted, -250.0, 250.0), 0.59) << rate << " " << speed;
      const double forward = (tracks.right + tracks.left) / 2.0;
      ASSERT_TRUE(forward == 0.0 || (forward > 0.0) == (speed > 0)) << rate << " " << speed;
    }
  }
}

TEST(Kinematics, ExtremesDoNotOverflow) {
  for (const uint16_t tread_mm : std::initializer_list<uint16_t>{1, 300}) {
    const SkidSteer kinematics(tread_mm);
    for (const int32_t rate : {INT32_MIN, -32768, 32768, INT32_MAX}) {
      for (const int16_t speed : std::initializer_list<int16_t>{INT16_MIN, INT16_MAX}) {
        const TrackSpeeds tracks = kinematics.tracks(speed, rate, kLimit_mm_per_s);
        // A rate beyond half a turn a second counts as half a turn a second.
        const double turn =
            std::clamp(turn_speed(tread_mm, rate < 0 ? -32767 : 32767), -250.0, 250.0);
        EXPECT_NEAR((tracks.right - tracks.left) / 2.0, turn, 0.51);
      }
    }
    const TrackSpeeds none = kinematics.tracks(100, 1000, 0);
    EXPECT_EQ(none.left, 0);
    EXPECT_EQ(none.right, 0);
  }
}

}  // namespace
}  // namespace screed
