// Conversions against exact arithmetic, over their whole ranges.
#include "firmware/math/units.h"

#include <gtest/gtest.h>

#include <cmath>

namespace screed {
namespace {

TEST(Units, TicksAreWholeAndRoundedDown) {
  for (int32_t ms = 0; ms <= INT16_MAX; ++ms)
    ASSERT_EQ(ticks_from_ms(static_cast<int16_t>(ms)), ms / 10) << ms;
}

TEST(Units, CentidegreesToAngle) {
  for (int32_t centidegrees = -17999; centidegrees <= 17999; ++centidegrees) {
    const double exact = centidegrees * 65536.0 / 36000.0;
    const Angle angle = angle_from_centidegrees(static_cast<int16_t>(centidegrees));
    ASSERT_LE(angle, exact + std::abs(exact) * 1e-4 + 1e-9) << centidegrees;
    ASSERT_GT(angle, exact - std::abs(exact) * 1e-4 - 1.0) << centidegrees;
  }
}

TEST(Units, AngleToCentidegreesIsTheFloor) {
  for (int32_t angle = INT16_MIN; angle <= INT16_MAX; ++angle) {
    ASSERT_EQ(centidegrees_from_angle(static_cast<Angle>(angle)),
              std::floor(angle * 36000.0 / 65536.0));
  }
}

TEST(Units, DegreesPerSecondToYawRate) {
  for (int32_t degrees = -179; degrees <= 179; ++degrees) {
    const double exact = degrees * 65536.0 / 360.0;
    const YawRate rate = yaw_rate_from_degrees(static_cast<int16_t>(degrees));
    ASSERT_LE(rate, exact + std::abs(exact) * 1e-4) << degrees;
    ASSERT_GT(rate, exact - std::abs(exact) * 1e-4 - 1.0) << degrees;
  }
}

}  // namespace
}  // namespace screed
