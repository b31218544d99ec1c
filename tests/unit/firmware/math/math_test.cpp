// Fixed-point arithmetic and units.
#include <gtest/gtest.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <utility>

#include "firmware/math/fixed.h"
#include "firmware/math/quaternion.h"
#include "firmware/math/sqrt.h"
#include "firmware/math/trig.h"
#include "firmware/math/units.h"

namespace screed {

namespace {

// Fixed-point math against long double and against wider integers.

constexpr long double kPi = std::numbers::pi_v<long double>;
constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();

/// A fixed sequence of numbers of all magnitudes, the extremes among them.
class Numbers {
 public:
  std::int32_t next() {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    const auto bits = static_cast<std::uint32_t>(state_ >> 32);
    const auto choice = static_cast<std::uint32_t>(state_ >> 8) % 64;
    if (choice == 0) return kMin;
    if (choice == 1) return kMax;
    return static_cast<std::int32_t>(bits) >> (choice % 32);
  }

 private:
  std::uint64_t state_ = 1;
};

std::int64_t floor_shift(std::int64_t value, int n) {
  return value >> n;
}

TEST(Fixed, AsrIsFloor) {
  EXPECT_EQ(asr(-1, 1), -1);
  EXPECT_EQ(asr(-5, 1), -3);
  EXPECT_EQ(asr(5, 1), 2);
  EXPECT_EQ(asr(kMin, 31), -1);
  EXPECT_EQ(asr(kMax, 0), kMax);
}

TEST(Fixed, AsrRoundIsToNearestHalvesUp) {
  EXPECT_EQ(asr_round(3, 1), 2);
  EXPECT_EQ(asr_round(-3, 1), -1);
  EXPECT_EQ(asr_round(-5, 2), -1);
  EXPECT_EQ(asr_round(-6, 2), -1);
  EXPECT_EQ(asr_round(-7, 2), -2);
}

TEST(Fixed, Saturation) {
  EXPECT_EQ(saturate_i16(32768), 32767);
  EXPECT_EQ(saturate_i16(kMin), -32768);
  EXPECT_EQ(saturate_i16(-7), -7);
  EXPECT_EQ(limit_i32(5, 3), 3);
  EXPECT_EQ(limit_i32(kMin, kMax), -kMax);
  EXPECT_EQ(clamp_i16(-5, -3, 3), -3);
  EXPECT_EQ(add_sat_i32(kMax, 1), kMax);
  EXPECT_EQ(add_sat_i32(kMin, -1), kMin);
  EXPECT_EQ(add_sat_i32(kMin, kMax), -1);
  EXPECT_EQ(abs_u32(kMin), 2147483648U);
  EXPECT_EQ(abs_i16(-32768), 32768U);
}

TEST(Fixed, ScaleQ16MatchesWideProductBitForBit) {
  Numbers numbers;
  for (int i = 0; i < 2000000; ++i) {
    const std::int32_t a = numbers.next();
    const auto k = static_cast<std::int16_t>(numbers.next());
    ASSERT_EQ(scale_q16(a, k), floor_shift(std::int64_t{a} * k + 32768, 16)) << a << " * " << k;
  }
  EXPECT_EQ(scale_q16(kMin, -32768), 1 << 30);
  EXPECT_EQ(scale_q16(kMax, 32767), floor_shift(std::int64_t{kMax} * 32767 + 32768, 16));
}

TEST(Trig, SineAndCosineOfEveryAngle) {
  for (std::int32_t a = -32768; a <= 32767; ++a) {
    const auto angle = static_cast<Angle>(a);
    const long double turn = static_cast<long double>(a) * kPi / 32768.0L;
    ASSERT_LE(std::fabs(sin_q15(angle) - 32768.0L * std::sin(turn)), 1.0L + 1e-9L) << a;
    ASSERT_LE(std::fabs(cos_q15(angle) - 32768.0L * std::cos(turn)), 1.0L + 1e-9L) << a;
    if (a > -32768) {
      ASSERT_EQ(sin_q15(static_cast<Angle>(-a)), -sin_q15(angle)) << a;
    }
  }
  EXPECT_EQ(sin_q15(0), 0);
  EXPECT_EQ(sin_q15(16384), 32767);
  EXPECT_EQ(cos_q15(-32768), -32767);
}

TEST(Trig, Atan2OfEveryAngleAtManyLengths) {
  for (const double length :
       {1.0, 3.0, 40.0, 1000.0, 32767.0, 65536.5, 1e6, 16777217.0, 2147483646.0}) {
    for (int step = 0; step < 65536; ++step) {
      const double direction = (step + 0.37) * std::numbers::pi / 32768.0;
      const auto y = static_cast<std::int32_t>(std::lround(length * std::sin(direction)));
      const auto x = static_cast<std::int32_t>(std::lround(length * std::cos(direction)));
      const long double exact =
          std::atan2(static_cast<long double>(y), static_cast<long double>(x)) * 32768.0L / kPi;
      ASSERT_LE(std::fabs(std::remainder(atan2_angle(y, x) - exact, 65536.0L)), 1.0L)
          << y << ", " << x;
    }
  }
}

TEST(Trig, AVectorTurnsByAnyAngleAndKeepsItsLength) {
  for (int angle = -32768; angle <= 32767; angle += 37) {
    const double turn = angle * std::numbers::pi / 32768.0;
    for (const auto& [x, y] : {std::pair<int, int>{100, 0}, {-7000, 12000}, {-32000, -5}, {1, 1}}) {
      std::int16_t vector[2] = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
      turn_vector(vector, static_cast<Angle>(angle));
      // Sine and cosine are off by 2^-15, sums are rounded down.
      const double off = 1.0 + std::hypot(x, y) / 16384.0;
      ASSERT_NEAR(vector[0], x * std::cos(turn) - y * std::sin(turn), off) << angle;
      ASSERT_NEAR(vector[1], x * std::sin(turn) + y * std::cos(turn), off) << angle;
      std::int16_t back[2] = {static_cast<std::int16_t>(x), static_cast<std::int16_t>(y)};
      turn_vector_back(back, static_cast<Angle>(angle));
      ASSERT_NEAR(back[0], x * std::cos(turn) + y * std::sin(turn), off) << angle;
      ASSERT_NEAR(back[1], -x * std::sin(turn) + y * std::cos(turn), off) << angle;
    }
  }
}

TEST(Trig, Atan2AtTheCorners) {
  EXPECT_EQ(atan2_angle(0, 0), 0);
  EXPECT_EQ(atan2_angle(0, 5), 0);
  EXPECT_EQ(atan2_angle(5, 0), 16384);
  EXPECT_EQ(atan2_angle(0, -5), -32768);
  EXPECT_EQ(atan2_angle(-5, 0), -16384);
  EXPECT_EQ(atan2_angle(7, 7), 8192);
  EXPECT_EQ(atan2_angle(kMin, kMin), -24576);
  EXPECT_EQ(atan2_angle(kMax, kMin), 24576);
  EXPECT_EQ(atan2_angle(kMin, kMax), -8192);
  EXPECT_EQ(atan2_angle(1, kMax), 0);
}

TEST(Trig, AnglesWrap) {
  EXPECT_EQ(wrap_angle(65536 + 5), 5);
  EXPECT_EQ(wrap_angle(32768), -32768);
  EXPECT_EQ(wrap_angle(-32769), 32767);
  EXPECT_EQ(angle_difference(-32768, 32767), 1);
  EXPECT_EQ(angle_difference(32767, -32768), -1);
}

TEST(Sqrt, IsFloorAroundEverySquare) {
  for (std::uint32_t root = 0; root <= 65535; ++root) {
    const std::uint32_t square = root * root;
    ASSERT_EQ(isqrt32(square), root);
    if (square > 0) {
      ASSERT_EQ(isqrt32(square - 1), root - 1);
    }
  }
  EXPECT_EQ(isqrt32(std::numeric_limits<std::uint32_t>::max()), 65535);
}

using Real = std::array<double, 4>;

Real real_of(const Quaternion& q) {
  const double one = kQ30One;
  return {q.w / one, q.x / one, q.y / one, q.z / one};
}

Quaternion fixed_of(const Real& q) {
  const auto component = [](double value) {
    return static_cast<std::int32_t>(std::lround(value * static_cast<double>(kQ30One)));
  };
  return {component(q[0]), component(q[1]), component(q[2]), component(q[3])};
}

Real unit(Numbers& numbers) {
  for (;;) {
    Real q{};
    double squared = 0.0;
    for (double& c : q) {
      c = static_cast<double>(numbers.next()) / 2147483648.0;
      squared += c * c;
    }
    if (squared < 1e-6) continue;
    for (double& c : q) c /= std::sqrt(squared);
    return q;
  }
}

Real hamilton_product(const Real& a, const Real& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

TEST(QuaternionMath, TurnsAreHamiltonProducts) {
  Numbers numbers;
  for (int i = 0; i < 20000; ++i) {
    const Quaternion q = fixed_of(unit(numbers));
    const Real change = unit(numbers);
    const auto small = [&](std::size_t k) {
      return static_cast<std::int16_t>(std::lround(32767.0 * change[k]));
    };
    const SmallQuaternion c = {small(0), small(1), small(2), small(3)};
    const Real a = real_of(q);
    const Real b = {c.w / 65536.0, c.x / 65536.0, c.y / 65536.0, c.z / 65536.0};
    const Real product = hamilton_product(a, b);
    const Real reverse = hamilton_product(b, a);
    Quaternion by_sensor = q;
    Quaternion by_earth = q;
    Quaternion at_once = q;
    turn_by_sensor(by_sensor, c);
    turn_by_earth(by_earth, c);
    turn_at_once(at_once, c);
    for (std::size_t k = 0; k < 4; ++k) {
      // Four terms rounded to nearest; then half of them rounded down, 2^-8 rounded to nearest.
      const double halved = real_of(by_sensor)[k] - a[k];
      ASSERT_NEAR(halved, product[k] / 2.0 - 0.25 / kQ30One, 1.255 / kQ30One);
      ASSERT_NEAR(real_of(by_earth)[k] - a[k], reverse[k] / 256.0, 0.51 / kQ30One);
      ASSERT_NEAR(real_of(at_once)[k] / 2.0, reverse[k], 2.01 / kQ30One);
    }
  }
}

TEST(QuaternionMath, RotationMatrixAndLength) {
  Numbers numbers;
  for (int i = 0; i < 20000; ++i) {
    const Real u = unit(numbers);
    const double w = u[0];
    const double x = u[1];
    const double y = u[2];
    const double z = u[3];
    const std::array<std::array<double, 3>, 3> expected = {
        {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
         {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
         {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
    const RotationMatrix got = rotation_matrix(fixed_of(u));
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        ASSERT_NEAR(got.row[r][c], expected[r][c] * 16384.0, 4.0) << "row " << r << " column " << c;
      }
    }
    ASSERT_NEAR(length_deficit_q24(fixed_of(u)), 0, 2);
    const double scale = 1.0005;
    const Real longer = {u[0] * scale, u[1] * scale, u[2] * scale, u[3] * scale};
    ASSERT_NEAR(length_deficit_q24(fixed_of(longer)), (1 - scale * scale) / 2 * 16777216.0, 2.0);
  }
}

TEST(QuaternionMath, DotOfClippedCountsFits) {
  const std::int16_t row[3] = {9459, 9459, 9459};  // (1, 1, 1) / sqrt(3) in Q14
  const std::int16_t low[3] = {-32768, -32768, -32768};
  EXPECT_EQ(dot_q14(row, low), -3 * 9459 * 32768);
}

// Conversions against exact arithmetic, over their whole ranges.

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
