// The attitude estimator against poses and motions that have a closed form.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <numbers>
#include <utility>

#include "firmware/estimation/attitude.h"

namespace screed {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadians = kPi / 180.0;
constexpr double kG = 1.0 / 0.244e-3;  // counts
constexpr double kDpsPerCount = 0.07;
constexpr double kTick = 0.01;  // s
constexpr double kUnitsPerDegree = 65536.0 / 360.0;

static_assert(sizeof(AttitudeEstimator) <= 160, "RAM budget of the estimator");

using Vec = std::array<double, 3>;
using Rot = std::array<double, 4>;  // w x y z, sensor to earth

Rot product(const Rot& a, const Rot& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

Rot about(const Vec& axis, double angle) {
  const double s = std::sin(angle / 2);
  return {std::cos(angle / 2), axis[0] * s, axis[1] * s, axis[2] * s};
}

/// Earth vector as the sensor sees it.
Vec seen(const Rot& q, const Vec& v) {
  const Rot conjugated = {q[0], -q[1], -q[2], -q[3]};
  const Rot r = product(product(conjugated, {0, v[0], v[1], v[2]}), q);
  return {r[1], r[2], r[3]};
}

/// Pose from heading (counter-clockwise from east), pitch (nose up) and roll (left side up), in
/// degrees.
Rot pose(double heading, double pitch, double roll) {
  return product(product(about({0, 0, 1}, heading * kRadians), about({0, 1, 0}, -pitch * kRadians)),
                 about({1, 0, 0}, roll * kRadians));
}

std::int16_t counts(double value) {
  return static_cast<std::int16_t>(std::lround(std::fmin(32767.0, std::fmax(-32768.0, value))));
}

const Vec kUp = {0, 0, kG};
const Vec kField = {0, 1100, -2500};  // north and down, counts

/// What ideal sensors read in a pose that turns with `rate` (degrees/s, sensor axes). `force`:
/// counts, earth axes.
ImuSample reading(const Rot& q, const Vec& rate = {0, 0, 0}, const Vec& force = kUp) {
  const Vec a = seen(q, force);
  const Vec m = seen(q, kField);
  ImuSample sample{};
  for (std::size_t i = 0; i < 3; ++i) {
    sample.imu.gyro()[i] = counts(rate[i] / kDpsPerCount);
    sample.imu.accel()[i] = counts(a[i]);
    sample.imu.mag()[i] = counts(m[i]);
  }
  sample.mag_fresh = true;
  return sample;
}

ImuSample without_mag(ImuSample sample) {
  sample.mag_fresh = false;
  return sample;
}

Rot estimate(const AttitudeEstimator& estimator) {
  const Quaternion& q = estimator.orientation();
  const double one = 1073741824.0;
  return {q.w / one, q.x / one, q.y / one, q.z / one};
}

/// Angle between two poses, degrees.
double angle_between(const Rot& a, const Rot& b) {
  const Rot d = product(a, {b[0], -b[1], -b[2], -b[3]});
  return 2 * std::atan2(std::hypot(d[1], std::hypot(d[2], d[3])), std::fabs(d[0])) / kRadians;
}

/// Angle between the vertical of two poses, degrees.
double inclination_between(const Rot& a, const Rot& b) {
  const Rot d = product(a, {b[0], -b[1], -b[2], -b[3]});
  return 2 * std::atan2(std::hypot(d[1], d[2]), std::hypot(d[0], d[3])) / kRadians;
}

double degrees(Angle angle) {
  return angle / kUnitsPerDegree;
}

void repeat(AttitudeEstimator& estimator, const ImuSample& sample, int ticks,
            bool may_rest = true) {
  for (int i = 0; i < ticks; ++i) estimator.update(sample, may_rest);
}

TEST(Attitude, StartsAsIdentityAndWaitsForAcceleration) {
  AttitudeEstimator estimator;
  ImuSample nothing{};
  nothing.imu.gyro()[2] = 1000;
  repeat(estimator, nothing, 400);
  EXPECT_FALSE(estimator.ready());
  EXPECT_EQ(estimator.orientation().w, 1 << 30);
  EXPECT_EQ(estimator.heading(), 0);
  repeat(estimator, reading(pose(0, 10, 0)), 1);
  EXPECT_NEAR(degrees(estimator.pitch()), 10.0, 0.3);
}

TEST(Attitude, StaticTiltHasTheProjectsSigns) {
  AttitudeEstimator estimator;
  ImuSample nose_up{};
  nose_up.imu.accel()[0] = 2048;  // gravity's reaction has a part along x when the nose is up
  nose_up.imu.accel()[2] = 3547;
  repeat(estimator, nose_up, 440);
  EXPECT_FALSE(estimator.ready());  // standstill was found after 1.5 s, and averaging takes 3 s
  repeat(estimator, nose_up, 20);
  EXPECT_TRUE(estimator.ready());
  EXPECT_NEAR(degrees(estimator.pitch()), 30.0, 0.05);
  EXPECT_NEAR(degrees(estimator.roll()), 0.0, 0.05);

  estimator.reset();
  ImuSample left_up{};
  left_up.imu.accel()[1] = 2048;
  left_up.imu.accel()[2] = 3547;
  repeat(estimator, left_up, 300);
  EXPECT_NEAR(degrees(estimator.roll()), 30.0, 0.05);
  EXPECT_NEAR(degrees(estimator.pitch()), 0.0, 0.05);
}

TEST(Attitude, EveryStaticPoseConverges) {
  for (int heading = -180; heading < 180; heading += 45) {
    for (int pitch = -85; pitch <= 85; pitch += 17) {
      for (int roll = -180; roll < 180; roll += 30) {
        const Rot truth = pose(heading, pitch, roll);
        AttitudeEstimator estimator;
        repeat(estimator, reading(truth), 310);
        ASSERT_LT(inclination_between(estimate(estimator), truth), 0.03)
            << heading << ' ' << pitch << ' ' << roll;
        ASSERT_LT(angle_between(estimate(estimator), truth), 0.1)
            << heading << ' ' << pitch << ' ' << roll;
        ASSERT_NEAR(degrees(estimator.pitch()), pitch, 0.1);
        if (std::abs(pitch) > 70) continue;
        ASSERT_NEAR(std::remainder(degrees(estimator.roll()) - roll, 360.0), 0.0, 0.1);
        ASSERT_NEAR(std::remainder(degrees(estimator.heading()) - heading, 360.0), 0.0, 0.1);
      }
    }
  }
}

TEST(Attitude, UpsideDownAtTheStart) {
  AttitudeEstimator estimator;
  ImuSample sample{};
  sample.imu.accel()[2] = -4098;
  repeat(estimator, sample, 300);
  EXPECT_NEAR(std::fabs(degrees(estimator.roll())), 180.0, 0.05);
}

struct Turn {
  Vec axis;
  int counts;  // gyroscope, whole counts, so that the readings are exact
};

class ConstantTurn : public ::testing::TestWithParam<Turn> {};

TEST_P(ConstantTurn, FollowsTheClosedForm) {
  const Vec axis = GetParam().axis;
  const double rate = GetParam().counts * kDpsPerCount;
  AttitudeEstimator estimator;
  double worst = 0.0;
  for (int tick = 0; tick <= 2000; ++tick) {
    const Rot truth = about(axis, rate * kTick * tick * kRadians);
    const Vec rates = {axis[0] * rate, axis[1] * rate, axis[2] * rate};
    estimator.update(without_mag(reading(truth, rates)), false);
    worst = std::fmax(worst, angle_between(estimate(estimator), truth));
  }
  // Without magnetometer nothing but the integration holds the turn about the vertical.
  EXPECT_LT(worst, 0.05 + std::fabs(rate) * 20.0 * 2e-5);
}

INSTANTIATE_TEST_SUITE_P(AllAxes, ConstantTurn,
                         ::testing::Values(Turn{{1, 0, 0}, 100}, Turn{{1, 0, 0}, -5000},
                                           Turn{{1, 0, 0}, 14285}, Turn{{0, 1, 0}, 100},
                                           Turn{{0, 1, 0}, 5000}, Turn{{0, 1, 0}, -14285},
                                           Turn{{0, 0, 1}, 3}, Turn{{0, 0, 1}, -100},
                                           Turn{{0, 0, 1}, 5000}, Turn{{0, 0, 1}, -14285}));

TEST(Attitude, FullScaleTurnStaysWithinTheSeries) {
  AttitudeEstimator estimator;
  const double rate = 28571 * kDpsPerCount;  // 2000 dps
  for (int tick = 0; tick <= 500; ++tick) {
    const Rot truth = about({0, 0, 1}, rate * kTick * tick * kRadians);
    estimator.update(without_mag(reading(truth, {0, 0, rate})), false);
    if (tick == 500) {
      EXPECT_LT(angle_between(estimate(estimator), truth), 10000.0 * 4e-5);
    }
  }
}

TEST(Attitude, YawRateIsAboutTheVerticalWhateverTheTilt) {
  for (const double pitch : {0.0, 40.0, -70.0}) {
    AttitudeEstimator estimator;
    for (int tick = 0; tick < 400; ++tick) {
      const Rot truth = pose(90.0 * kTick * tick, pitch, 20.0);
      const Vec rates = seen(truth, {0, 0, 90.0});
      estimator.update(reading(truth, rates), false);
    }
    EXPECT_NEAR(estimator.yaw_rate(), 90.0 * kUnitsPerDegree, 30.0) << pitch;
  }
}

TEST(Attitude, BiasIsFoundAtRest) {
  AttitudeEstimator estimator;
  const Rot truth = pose(30, 5, -8);
  ImuSample sample = reading(truth);
  sample.imu.gyro()[0] = -20;
  sample.imu.gyro()[1] = 30;
  sample.imu.gyro()[2] = 300;  // 21 dps
  repeat(estimator, sample, 140);
  EXPECT_FALSE(estimator.at_rest());
  EXPECT_EQ(estimator.gyro_bias_mdps(2), 0);
  repeat(estimator, sample, 300);
  EXPECT_TRUE(estimator.at_rest());
  EXPECT_NEAR(estimator.gyro_bias_mdps(0), -1400, 10);
  EXPECT_NEAR(estimator.gyro_bias_mdps(1), 2100, 10);
  EXPECT_NEAR(estimator.gyro_bias_mdps(2), 21000, 60);
  EXPECT_NEAR(estimator.yaw_rate(), 0, 20);
  repeat(estimator, sample, 3000);
  EXPECT_LT(inclination_between(estimate(estimator), truth), 0.05);
  EXPECT_LT(angle_between(estimate(estimator), truth),
            0.6);  // what the start lost is pulled back slowly
}

// The first standstill takes the average anew, for 3 s; what was known until then remains known.
TEST(Attitude, RollAndPitchRemainKnownInTheFirstStandstill) {
  AttitudeEstimator estimator;
  const Rot truth = pose(30, 5, -8);
  ImuSample sample = reading(truth);
  for (int tick = 0; tick < 400; ++tick) {
    EXPECT_EQ(estimator.known(), tick >= AttitudeEstimator::kStartTicks) << tick;
    estimator.update(sample, false);
  }
  ASSERT_TRUE(estimator.ready());
  int averaging = 0;
  for (int tick = 0; tick < 600; ++tick) {
    estimator.update(sample, true);
    if (!estimator.ready()) ++averaging;
    EXPECT_TRUE(estimator.known());
    EXPECT_LT(inclination_between(estimate(estimator), truth), 0.3);
  }
  EXPECT_GT(averaging, 250) << "else this tests nothing";
}

TEST(Attitude, LargeBiasAtTheStartLeavesNoTilt) {
  AttitudeEstimator estimator;
  const Rot truth = pose(30, 0, 0);
  ImuSample sample = reading(truth);
  sample.imu.gyro()[0] = 285;  // 20 dps: 30 degrees until standstill is certain
  sample.imu.gyro()[2] = 285;
  double worst = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    estimator.update(sample);
    if (estimator.ready())
      worst = std::fmax(worst, inclination_between(estimate(estimator), truth));
  }
  EXPECT_TRUE(estimator.ready());
  EXPECT_LT(worst, 0.3);
  EXPECT_NEAR(degrees(estimator.heading()), 30.0, 1.0);
}

TEST(Attitude, NoRestWhileTheCallerForbidsIt) {
  AttitudeEstimator estimator;
  ImuSample sample = without_mag(reading(pose(0, 0, 0)));
  sample.imu.gyro()[2] = 14;  // a real turn of 1 degree/s
  repeat(estimator, sample, 1000, false);
  EXPECT_FALSE(estimator.at_rest());
  EXPECT_EQ(estimator.gyro_bias_mdps(2), 0);
  EXPECT_NEAR(degrees(estimator.heading()), 0.98 * 9.99, 0.05);
}

TEST(Attitude, BiasIsFoundInMotion) {
  AttitudeEstimator estimator;
  const int bias = 14;  // 0.98 dps on x and y
  for (int tick = 0; tick < 30000; ++tick) {
    const double phase = 2 * kPi * 0.4 * kTick * tick;
    const double roll = 20.0 * std::sin(phase);
    const double rate = 20.0 * 2 * kPi * 0.4 * std::cos(phase);
    ImuSample sample = reading(pose(0, 0, roll), {rate, 0, 0});
    sample.imu.gyro()[0] = static_cast<std::int16_t>(sample.imu.gyro()[0] + bias);
    sample.imu.gyro()[1] = static_cast<std::int16_t>(sample.imu.gyro()[1] + bias);
    estimator.update(sample, false);
  }
  EXPECT_NEAR(estimator.gyro_bias_mdps(0), 980, 60);
  EXPECT_NEAR(estimator.gyro_bias_mdps(1), 980, 60);
}

TEST(Attitude, BiasStopsAtItsLimit) {
  AttitudeEstimator estimator;
  ImuSample sample = reading(pose(0, 0, 0));
  sample.imu.gyro()[0] = 400;  // 28 dps
  repeat(estimator, sample, 1000);
  ASSERT_NEAR(estimator.gyro_bias_mdps(0), 28000, 30);
  sample.imu.gyro()[0] = 450;  // 31.5 dps
  repeat(estimator, sample, 30000, false);
  EXPECT_NEAR(estimator.gyro_bias_mdps(0), 30000, 10);
}

TEST(Attitude, VehicleAccelerationAveragesOut) {
  AttitudeEstimator estimator;
  const Rot truth = pose(0, 0, 0);
  repeat(estimator, reading(truth), 600);
  double worst = 0.0;
  for (int tick = 0; tick < 1200; ++tick) {
    // 0.3 g forward, then 0.3 g back, half a second each: the accelerometer alone would be wrong by
    // 17 degrees.
    const double along = (tick / 50) % 2 == 0 ? 0.3 * kG : -0.3 * kG;
    estimator.update(reading(truth, {0, 0, 0}, {along, 0, kG}), false);
    worst = std::fmax(worst, inclination_between(estimate(estimator), truth));
  }
  EXPECT_LT(worst, 1.2);
}

TEST(Attitude, VibrationOfTheTracksAveragesOut) {
  AttitudeEstimator estimator;
  const Rot truth = pose(0, 10, 0);
  repeat(estimator, reading(truth), 600);
  std::uint32_t state = 3;
  const auto noise = [&state](int amplitude) {  // uniform, whole counts
    state = state * 1664525U + 1013904223U;
    return static_cast<int>(state >> 16) % (2 * amplitude + 1) - amplitude;
  };
  double worst = 0.0;
  std::array<int, 3>
      shake{};  // angle, in counts times ticks: a vibration that turns nothing for good
  for (int tick = 0; tick < 6000; ++tick) {
    ImuSample sample = reading(truth);
    for (std::size_t i = 0; i < 3; ++i) {
      const int angle = noise(140);
      sample.imu.gyro()[i] =
          static_cast<std::int16_t>(sample.imu.gyro()[i] + angle - shake[i]);  // up to 20 dps
      shake[i] = angle;
      sample.imu.accel()[i] =
          static_cast<std::int16_t>(sample.imu.accel()[i] + noise(820));  // +-0.2 g
    }
    estimator.update(sample, false);
    worst = std::fmax(worst, inclination_between(estimate(estimator), truth));
  }
  RecordProperty("worst_millidegrees", static_cast<int>(1000 * worst));
  EXPECT_LT(worst, 1.0);
}

TEST(Attitude, ClippedAccelerationIsSurvived) {
  AttitudeEstimator estimator;
  const Rot truth = pose(0, 0, 0);
  repeat(estimator, reading(truth), 600);
  double worst = 0.0;
  int clipped = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    // Shaking about a place: the true acceleration has no mean and no net velocity, the clipped one
    // neither.
    const double along = 12.0 * kG * std::cos(2 * kPi * 5.0 * kTick * tick);
    const ImuSample sample = reading(truth, {0, 0, 0}, {along, 0.3 * along, kG});
    clipped += sample.imu.accel()[0] == 32767 || sample.imu.accel()[0] == -32768 ? 1 : 0;
    estimator.update(sample, false);
    worst = std::fmax(worst, inclination_between(estimate(estimator), truth));
  }
  EXPECT_GT(clipped, 400);
  EXPECT_LT(worst, 1.5);
}

TEST(Attitude, AnyInputKeepsAUnitQuaternion) {
  AttitudeEstimator estimator;
  std::uint32_t state = 7;
  const auto next = [&state] {
    state = state * 1664525U + 1013904223U;
    const std::uint32_t choice = state >> 29;
    if (choice == 0) return std::numeric_limits<std::int16_t>::min();
    if (choice == 1) return std::numeric_limits<std::int16_t>::max();
    return static_cast<std::int16_t>(static_cast<std::uint16_t>(state >> 8));
  };
  for (int tick = 0; tick < 50000; ++tick) {
    ImuSample sample{};
    const bool held = (tick / 500) % 2 == 1;  // stretches of constant extremes as well
    if (!held || tick % 500 == 0) {
      for (std::size_t i = 0; i < 3; ++i) {
        sample.imu.gyro()[i] = next();
        sample.imu.accel()[i] = next();
        sample.imu.mag()[i] = next();
      }
    } else {
      for (std::size_t i = 0; i < 3; ++i) {
        sample.imu.gyro()[i] = sample.imu.accel()[i] = sample.imu.mag()[i] =
            std::numeric_limits<std::int16_t>::min();
      }
    }
    sample.mag_fresh = tick % 3 != 0;
    estimator.update(sample);
    const Rot q = estimate(estimator);
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    ASSERT_NEAR(length, 1.0, 2e-3) << tick;
    for (std::uint8_t axis = 0; axis < 3; ++axis)
      ASSERT_LE(std::abs(estimator.gyro_bias_mdps(axis)), 30010);
  }
}

TEST(Attitude, LostAttitudeStartsAgain) {
  AttitudeEstimator estimator;
  ImuSample sample = reading(pose(0, 0, 0));
  sample.imu.gyro()[1] = 7;
  repeat(estimator, sample, 600);
  ImuSample turned_over = reading(pose(0, 0, 170));  // and the gyroscope saw nothing of it
  turned_over.imu.gyro()[1] = 7;
  repeat(estimator, turned_over, 1500);
  EXPECT_NEAR(degrees(estimator.roll()), 170.0, 0.1);
  EXPECT_TRUE(estimator.ready());
}

TEST(Attitude, MagneticDisturbanceTurnsSlowly) {
  AttitudeEstimator estimator;
  const Rot truth = pose(60, 0, 0);
  repeat(estimator, reading(truth), 1000);
  ASSERT_NEAR(degrees(estimator.heading()), 60.0, 0.1);
  ImuSample disturbed = reading(truth);
  std::swap(disturbed.imu.mag()[0], disturbed.imu.mag()[1]);
  for (int tick = 0; tick < 200; ++tick) {
    disturbed.imu.gyro()[2] = tick % 2 == 0 ? 3 : -3;
    estimator.update(disturbed);
  }
  EXPECT_NEAR(degrees(estimator.heading()), 60.0, 4.1);  // at most 2 degrees/s for 2 s
  repeat(estimator, reading(truth), 4000);
  EXPECT_NEAR(degrees(estimator.heading()), 60.0, 0.2);
}

/// Steel passes by: a field of another strength or inclination, which points elsewhere.
ImuSample near_steel(const Rot& truth, const Vec& field) {
  ImuSample sample = reading(truth);
  const Vec m = seen(truth, field);
  for (std::size_t i = 0; i < 3; ++i) sample.imu.mag()[i] = counts(m[i]);
  return sample;
}

TEST(Attitude, AFieldThatIsNotTheSitesDoesNotTurnTheHeading) {
  for (const Vec& field : {Vec{1500, 1100, -2500 * 1.3}, Vec{900, 800, -1300}}) {
    AttitudeEstimator estimator;
    const Rot truth = pose(60, 0, 0);
    repeat(estimator, reading(truth), 2000);
    ASSERT_FALSE(estimator.mag_disturbed());
    EXPECT_EQ(estimator.heading_sigma(), 4) << "2 degrees";
    repeat(estimator, near_steel(truth, field), AttitudeEstimator::kMagHitchTicks);
    EXPECT_FALSE(estimator.mag_disturbed()) << "a hitch";
    repeat(estimator, near_steel(truth, field), 180);
    EXPECT_TRUE(estimator.mag_disturbed());
    EXPECT_NEAR(degrees(estimator.heading()), 60.0, 0.1) << "the gyroscope says that it stands";
    repeat(estimator, reading(truth), 1);
    EXPECT_FALSE(estimator.mag_disturbed());
  }
}

// A robot that is carried to another site takes the field that it finds there.
TEST(Attitude, AFieldThatStaysIsTakenForThatOfTheSite) {
  AttitudeEstimator estimator;
  const Rot truth = pose(0, 0, 0);
  repeat(estimator, reading(truth), 2000);
  const ImuSample elsewhere = near_steel(truth, {0, 1400, -3300});
  repeat(estimator, elsewhere, 500);
  EXPECT_TRUE(estimator.mag_disturbed());
  repeat(estimator, elsewhere, 6000);
  EXPECT_FALSE(estimator.mag_disturbed());
  EXPECT_EQ(estimator.heading_sigma(), 4);
}

TEST(Attitude, WithoutAMagnetometerTheHeadingAges) {
  AttitudeEstimator estimator;
  repeat(estimator, without_mag(reading(pose(0, 0, 0))), 100);
  EXPECT_EQ(estimator.heading_sigma(), 255) << "never set";
  repeat(estimator, reading(pose(0, 0, 0)), 400);
  repeat(estimator, without_mag(reading(pose(0, 0, 0))), 2048 * 5);
  EXPECT_EQ(estimator.heading_sigma(), 9) << "0.5 degrees in 20 s";
}

TEST(Attitude, StaleMagnetometerIsNotLookedAt) {
  AttitudeEstimator estimator;
  repeat(estimator, without_mag(reading(pose(90, 0, 0))), 400);
  EXPECT_FALSE(estimator.heading_ready());
  EXPECT_NEAR(degrees(estimator.heading()), 0.0, 0.05);
  repeat(estimator, reading(pose(90, 0, 0)), 1);
  EXPECT_TRUE(estimator.heading_ready());
  EXPECT_NEAR(degrees(estimator.heading()), 90.0, 0.1);
}

TEST(Attitude, SlowerMagnetometerHasTheSameTimeConstant) {
  std::array<double, 2> left{};
  for (std::size_t k = 0; k < 2; ++k) {
    AttitudeEstimator estimator;
    const int every = k == 0 ? 1 : 4;
    for (int tick = 0; tick < 8000; ++tick) {
      const ImuSample sample =
          reading(pose(tick < 5000 ? 0 : 5, 0, 0));  // a turn the gyroscope did not see
      estimator.update(tick % every == 0 ? sample : without_mag(sample));
      if (tick == 5900) left[k] = 5.0 - degrees(estimator.heading());
    }
    EXPECT_NEAR(degrees(estimator.heading()), 5.0, 0.2);
  }
  EXPECT_NEAR(left[0], 5.0 * std::exp(-1.0), 0.1);
  EXPECT_NEAR(left[1], left[0], 0.1);
}

TEST(Attitude, ResetForgetsEverything) {
  AttitudeEstimator used;
  ImuSample sample = reading(pose(30, 20, 10), {1, 1, 1});
  repeat(used, sample, 900);
  used.reset();
  AttitudeEstimator fresh;
  for (int tick = 0; tick < 400; ++tick) {
    used.update(sample);
    fresh.update(sample);
    ASSERT_EQ(used.orientation().w, fresh.orientation().w);
    ASSERT_EQ(used.orientation().z, fresh.orientation().z);
    ASSERT_EQ(used.yaw_rate(), fresh.yaw_rate());
    ASSERT_EQ(used.gyro_bias_mdps(1), fresh.gyro_bias_mdps(1));
  }
}

}  // namespace
}  // namespace screed
