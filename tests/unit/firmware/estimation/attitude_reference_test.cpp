// The attitude estimator, tick by tick, against its equations in real numbers (the head of
// attitude.cpp): rest, bias, driving, a magnetometer that is slow, silent or disturbed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <numbers>
#include <string>
#include <utility>

#include "firmware/estimation/attitude.h"

namespace screed {
namespace {

constexpr double kTick_s = 0.01;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kG = 4096.0;  // counts
/// Half an angle a tick.
constexpr double kPerCount = 0.07 * kDegree * kTick_s / 2.0;

using Vec = std::array<double, 3>;
struct Rot {
  double w;
  double x;
  double y;
  double z;
};

Rot operator*(const Rot& a, const Rot& b) {
  return {
      a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
      a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
Rot operator+(const Rot& a, const Rot& b) {
  return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z};
}
Rot conjugate(const Rot& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
Vec turned(const Rot& q, const Vec& v) {
  const Rot r = q * Rot{0.0, v[0], v[1], v[2]} * conjugate(q);
  return {r.x, r.y, r.z};
}
Rot rotation(const Vec& axis, double angle) {
  const double s = std::sin(angle / 2.0);
  return {std::cos(angle / 2.0), axis[0] * s, axis[1] * s, axis[2] * s};
}
double square(double x) {
  return x * x;
}

/// The equations, without the limits of numbers.
struct Reference {
  Rot q{1.0, 0.0, 0.0, 0.0};
  Vec gravity{};
  Vec slope{};
  Vec bias{};  ///< half an angle a tick
  std::array<double, 6> mean{};
  double yaw_rate = 0.0;  ///< rad/s
  int ticks = 0;
  int mag_samples = 0;
  int mag_age = 0;
  int rest_ticks = 0;
  int bias_samples = 0;
  int distrusted = 0;
  double strength = 0.0;
  double vertical = 0.0;

  void update(const ImuSample& sample, bool may_rest) {
    const Vec accel{1.0 * sample.imu.accel()[0], 1.0 * sample.imu.accel()[1],
                    1.0 * sample.imu.accel()[2]};
    const bool first = ticks == 0;
    if (first && !align(accel)) return;
    detect_rest(sample, may_rest);
    if (rest_ticks == 150) learn_bias_at_rest();
    Vec half{};
    if (!first) half = integrate(sample);
    yaw_rate = turned(q, half)[2] * 2.0 / kTick_s;
    filter_gravity(turned(q, accel));
    const double most = 32767.0 / 16777216.0;
    Rot correction{(1.0 - square(q.w) - square(q.x) - square(q.y) - square(q.z)) / 2.0,
                   std::clamp(gravity[1] / (2.0 * kG), -most, most),
                   std::clamp(-gravity[0] / (2.0 * kG), -most, most), 0.0};
    if (ticks == 300) {
      const Vec seen = turned(conjugate(q), {correction.x, correction.y, 0.0});
      for (int i = 0; i < 3; ++i) {
        const double limit = 30.0 * kDegree * kTick_s / 2.0;
        bias[i] = std::clamp(bias[i] - 0.02 * kTick_s * seen[i], -limit, limit);
      }
    }
    mag_age = std::min(mag_age + 1, 10);
    ++distrusted;
    const Vec mag{1.0 * sample.imu.mag()[0], 1.0 * sample.imu.mag()[1], 1.0 * sample.imu.mag()[2]};
    if (sample.mag_fresh && trust(mag)) {
      correction.z = heading_correction(turned(q, mag), most);
      distrusted = 0;
    }
    q = q + correction * q;
    gravity[0] += 2.0 * correction.y * gravity[2];
    gravity[1] -= 2.0 * correction.x * gravity[2];
    if (gravity[2] < kG / 4.0) {
      slope = {};
      ticks = 0;
      mag_samples = 0;
    }
  }

 private:
  bool align(const Vec& a) {
    const double length = std::hypot(a[0], a[1], a[2]);
    if (length < kG / 8.0) return false;
    // Along the bisector of the measured vertical and z; upside down from a pose rolled by half a
    // turn.
    const Rot tilt{length + std::fabs(a[2]), a[2] < 0.0 ? -a[1] : a[1], -a[0], 0.0};
    const double scale = 1.0 / std::sqrt(square(tilt.w) + square(tilt.x) + square(tilt.y));
    const Rot upright{tilt.w * scale, tilt.x * scale, tilt.y * scale, 0.0};
    q = a[2] < 0.0 ? upright * Rot{0.0, 1.0, 0.0, 0.0} : upright;
    gravity = {0.0, 0.0, kG};
    return true;
  }
  void detect_rest(const ImuSample& sample, bool may_rest) {
    bool quiet = may_rest;
    for (std::size_t i = 0; i < 6; ++i) {
      const double count = i < 3 ? sample.imu.gyro()[i] : sample.imu.accel()[i - 3];
      if (ticks == 0) mean[i] = count;
      const double change = count - mean[i];
      mean[i] += change / 64.0;
      if (std::fabs(change) > (i < 3 ? 29.0 : 200.0)) quiet = false;
      if (i < 3 && std::fabs(mean[i]) > 428.0) quiet = false;
    }
    rest_ticks = quiet ? std::min(rest_ticks + 1, 150) : 0;
  }
  void learn_bias_at_rest() {
    if (bias_samples == 0) {
      slope = {};
      ticks = 1;
      mag_samples = std::min(mag_samples, 1);
    }
    bias_samples = std::min(bias_samples + 1, 100);
    for (std::size_t i = 0; i < 3; ++i) {
      bias[i] += (mean[i] * kPerCount - bias[i]) / (bias_samples + 1);
    }
  }
  Vec integrate(const ImuSample& sample) {
    Vec h{};
    double s = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      h[i] = sample.imu.gyro()[i] * kPerCount - bias[i];
      s += h[i] * h[i];
    }
    const double sine = 1.0 - s / 6.0;
    q = q + q * Rot{-s / 2.0, h[0] * sine, h[1] * sine, h[2] * sine};
    return h;
  }
  void filter_gravity(const Vec& accel) {
    const double wn = std::numbers::sqrt2 / 3.0 * kTick_s;
    const bool starting = ticks < 300;
    if (starting) ++ticks;
    for (std::size_t i = 0; i < 3; ++i) {
      const double difference = accel[i] - gravity[i];
      if (starting) {
        gravity[i] += difference / (ticks + 1);
      } else {
        slope[i] += wn * wn * difference - std::numbers::sqrt2 * wn * slope[i];
        gravity[i] += slope[i];
      }
    }
  }
  bool trust(const Vec& mag) {
    const double seen = std::hypot(mag[0], mag[1], mag[2]);
    const double seen_vertical = turned(q, mag)[2];
    if (mag_samples < 300 || distrusted > 2048) {
      strength = seen;
      vertical = seen_vertical;
    }
    return std::max(std::fabs(seen - strength), std::fabs(seen_vertical - vertical)) < seen / 8.0;
  }
  /// Half the angle.
  double heading_correction(const Vec& mag, double most) {
    const double error = std::atan2(mag[0], mag[1]);
    const int age = mag_age;
    mag_age = 0;
    if (mag_samples == 0) {
      mag_samples = 1;
      q = rotation({0.0, 0.0, 1.0}, error) * q;
      return 0.0;
    }
    const double gain = mag_samples < 900 ? 1.0 / (mag_samples + 1) : age * kTick_s / 9.0;
    const double limit = mag_samples < 300 ? most : age * 0.01 * kDegree;
    mag_samples = std::min(mag_samples + 1, 900);
    return std::clamp(gain * error / 2.0, -limit, limit);
  }
};

/// What both are shown.
struct Reading {
  Vec gyro{};                 ///< counts
  Vec accel{0.0, 0.0, kG};    ///< counts
  Vec mag{0.0, 1100, -2500};  ///< counts
  bool mag_fresh = true;
  bool may_rest = true;
};

/// Runs both, and compares after each tick: angle between the orientations (degrees), bias (mdps),
/// yaw rate (units), and all that they say of themselves.
class Comparison {
 public:
  void run(int count, const std::function<Reading(int)>& readings) {
    for (int i = 0; i < count; ++i) {
      tick(readings(i));
      if (testing::Test::HasFailure()) return;
    }
  }
  void tick(const Reading& reading) {
    ImuSample sample{};
    for (std::size_t i = 0; i < 3; ++i) {
      sample.imu.gyro()[i] = static_cast<int16_t>(std::lround(reading.gyro[i]));
      sample.imu.accel()[i] = static_cast<int16_t>(std::lround(reading.accel[i]));
      sample.imu.mag()[i] = static_cast<int16_t>(std::lround(reading.mag[i]));
    }
    sample.mag_fresh = reading.mag_fresh;
    estimator.update(sample, reading.may_rest);
    reference.update(sample, reading.may_rest);
    ++ticks;
    const Quaternion& q = estimator.orientation();
    const double one = 1073741824.0;
    const Rot between = Rot{q.w / one, q.x / one, q.y / one, q.z / one} * conjugate(reference.q);
    const double angle =
        2.0 * std::atan2(std::hypot(between.x, between.y, between.z), std::fabs(between.w));
    EXPECT_LT(angle / kDegree, tolerance_deg) << "orientation" << at();
    const double yaw_rate = reference.yaw_rate * 65536.0 / (2.0 * std::numbers::pi);
    EXPECT_NEAR(estimator.yaw_rate(), yaw_rate, 20.0 + 1e-3 * std::fabs(yaw_rate)) << at();
    for (std::uint8_t axis = 0; axis < 3; ++axis) {
      const double mdps = reference.bias[axis] / kPerCount * 70.0;
      EXPECT_NEAR(estimator.gyro_bias_mdps(axis), mdps, bias_tolerance_mdps) << int{axis} << at();
    }
    EXPECT_EQ(estimator.at_rest(), reference.rest_ticks == 150) << at();
    EXPECT_EQ(estimator.ready(), reference.ticks == 300) << at();
    EXPECT_EQ(estimator.heading_ready(), reference.mag_samples != 0) << at();
    EXPECT_EQ(estimator.mag_disturbed(), reference.distrusted > 20) << at();
  }

  AttitudeEstimator estimator;
  Reference reference;
  double tolerance_deg = 0.02;
  double bias_tolerance_mdps = 3.0;
  int ticks = 0;

 private:
  std::string at() const { return " after tick " + std::to_string(ticks); }
};

Reading tilted() {
  Reading reading;
  reading.accel = {-600.0, 900.0, 3900.0};
  reading.mag = {700.0, 1000.0, -2300.0};
  return reading;
}

TEST(AttitudeReference, ABiasThatDriftsIsFollowedAtRest) {
  Comparison both;
  both.run(900, [](int i) {
    Reading reading = tilted();
    reading.gyro = {40.0 + i / 50.0, -30.0, 25.0 - i / 40.0};
    return reading;
  });
}

TEST(AttitudeReference, ADriveThatShakesAndTurns) {
  Comparison both;
  both.run(400, [](int) { return tilted(); });
  both.run(3000, [](int i) {
    Reading reading = tilted();
    reading.gyro = {200.0 * std::sin(0.03 * i), 300.0 * std::cos(0.021 * i), 150.0};
    reading.accel[0] += 1500.0 * std::sin(0.004 * i);
    reading.accel[1] += i % 500 < 100 ? 1200.0 : 0.0;
    reading.mag_fresh = false;
    reading.may_rest = false;
    return reading;
  });
}

TEST(AttitudeReference, AFastTurnAboutAnyAxis) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Comparison both;
    both.run(axis == 2 ? 300 : 8, [axis](int) {
      Reading reading = tilted();
      reading.gyro[axis] = 28000.0;
      reading.mag_fresh = false;
      return reading;
    });
  }
}

/// A field that seems to turn to and fro by so many degrees.
Reading swaying(int i, double degrees) {
  const double angle = degrees * kDegree * std::sin(0.05 * i);
  Reading reading;
  reading.mag = {1100.0 * std::sin(angle), 1100.0 * std::cos(angle), -2500.0};
  reading.may_rest = false;
  return reading;
}

TEST(AttitudeReference, HeadingIsTheMeanOfTheFirstSamplesThenFollowsSlowly) {
  for (const int every : {1, 3, 14}) {
    Comparison both;
    both.run(14000, [every](int i) {
      Reading reading = swaying(i, i < 300 ? 60.0 : 20.0);
      reading.mag_fresh = i % every == 0;
      return reading;
    });
  }
}

TEST(AttitudeReference, AMagnetometerThatWasSilentCountsAsTenTicks) {
  Comparison both;
  both.run(1000, [](int i) { return swaying(i, 2.0); });
  both.run(260, [](int i) {
    Reading reading = swaying(i, 2.0);
    reading.mag_fresh = false;
    return reading;
  });
  Reading turned;
  turned.mag = {60.0, 1098.0, -2500.0};
  turned.may_rest = false;
  both.tick(turned);
}

TEST(AttitudeReference, AnotherFieldIsTakenForTheSitesAfterItsTime) {
  for (const Vec& field : {Vec{0.0, 1500.0, -3300.0}, Vec{0.0, 2500.0, -1100.0}}) {
    Comparison both;
    both.run(400, [](int i) { return swaying(i, 2.0); });
    both.run(2400, [&field](int i) {
      Reading reading = swaying(i, 0.0);
      reading.mag = field;
      return reading;
    });
  }
}

/// Of the field's strength; another one is not trusted.
TEST(AttitudeReference, AnEighthOfTheFieldsStrengthIsTolerated) {
  for (const double factor : {0.90, 0.88, 1.13, 1.15}) {
    Comparison both;
    both.run(400, [](int i) { return swaying(i, 2.0); });
    both.run(100, [factor](int i) {
      Reading reading = swaying(i, 2.0);
      for (double& count : reading.mag) count *= factor;
      return reading;
    });
    EXPECT_EQ(both.estimator.mag_disturbed(), factor < 0.89 || factor > 1.14) << factor;
  }
}

TEST(AttitudeReference, StandstillEndsAtTheLimitsOfNoise) {
  for (const auto& [axis, jump] : {std::pair{0, 28.0},
                                   {0, 30.0},
                                   {1, -30.0},
                                   {2, 28.0},
                                   {2, 30.0},
                                   {3, 198.0},
                                   {3, -202.0},
                                   {4, 202.0},
                                   {5, 198.0},
                                   {5, 202.0}}) {
    Comparison both;
    both.run(200, [](int) { return Reading{}; });
    Reading reading;
    (axis < 3 ? reading.gyro[axis] : reading.accel[axis - 3]) += jump;
    both.tick(reading);
    const bool noise = std::fabs(jump) < (axis < 3 ? 29.0 : 200.0);
    EXPECT_EQ(both.estimator.at_rest(), noise) << axis << ' ' << jump;
  }
}

TEST(AttitudeReference, AnEvenTurnBeyondAnyBiasIsNoStandstill) {
  for (const double rate : {420.0, 436.0, -436.0}) {
    Comparison both;
    both.run(200, [rate](int) {
      Reading reading;
      reading.gyro[1] = rate;
      return reading;
    });
    EXPECT_EQ(both.estimator.at_rest(), std::fabs(rate) < 428.0) << rate;
  }
}

TEST(AttitudeReference, AnyAccelerationAligns) {
  for (const Vec& accel : {Vec{300.0, 0.0, 414.0}, Vec{300.0, 0.0, 417.0}, Vec{0.0, 512.0, 0.0},
                           Vec{900.0, -500.0, -3900.0}, Vec{-2000.0, 3000.0, -100.0},
                           Vec{4000.0, 100.0, 0.0}, Vec{100.0, 4000.0, 1.0}}) {
    Comparison both;
    both.tolerance_deg = 0.3;  // the first pose has few digits
    Reading reading;
    reading.accel = accel;
    both.tick(reading);
  }
}

TEST(AttitudeReference, GravityThatVanishesIsALostAttitude) {
  Comparison both;
  both.run(500, [](int i) { return swaying(i, 2.0); });
  both.run(1500, [](int i) {
    Reading reading = swaying(i, 2.0);
    reading.accel = {100.0, 0.0, std::max(4096.0 - 8.0 * i, 300.0)};
    return reading;
  });
  EXPECT_FALSE(both.estimator.ready());
}

}  // namespace
}  // namespace screed
