// The simulated IMU: axes, scale, noise as in the data sheets, rates of the chips.
#include "host_sim/devices/sensors/imu_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace screed {
namespace {

constexpr double kGravity = 9.80665;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kOneG_counts = 1000.0 / 0.244;

/// At rest in an attitude: gravity's reaction along the world's z.
ImuTruth at_rest(const Eigen::Matrix3d& body_to_world) {
  return {Eigen::Vector3d::Zero(), body_to_world.transpose() * Eigen::Vector3d(0.0, 0.0, kGravity),
          body_to_world, 0.0};
}

Eigen::Matrix3d turn(double angle, const Eigen::Vector3d& axis) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

SensorSample measure(ImuModel& imu, const ImuTruth& truth) {
  SensorSample sample{};
  imu.measure(truth, sample);
  return sample;
}

SensorSample ideal(const ImuTruth& truth) {
  ImuModel imu(1, ImuErrors::none());
  return measure(imu, truth);
}

TEST(ImuModel, LevelAtRest) {
  const SensorSample sample = ideal(at_rest(Eigen::Matrix3d::Identity()));
  EXPECT_EQ(sample.imu.accel()[0], 0);
  EXPECT_EQ(sample.imu.accel()[1], 0);
  EXPECT_NEAR(sample.imu.accel()[2], kOneG_counts, 0.5);
  for (const int16_t rate : sample.imu.gyro()) EXPECT_EQ(rate, 0);
}

TEST(ImuModel, OnItsSideAndOnItsNose) {
  // Roll > 0: left side up, so the y axis points up.
  const SensorSample left_up = ideal(at_rest(turn(90.0 * kDegree, Eigen::Vector3d::UnitX())));
  EXPECT_NEAR(left_up.imu.accel()[1], kOneG_counts, 0.5);
  EXPECT_NEAR(left_up.imu.accel()[2], 0.0, 0.5);
  // Nose up: x points up. A right-handed turn about y takes the nose down.
  const SensorSample nose_up = ideal(at_rest(turn(-90.0 * kDegree, Eigen::Vector3d::UnitY())));
  EXPECT_NEAR(nose_up.imu.accel()[0], kOneG_counts, 0.5);
  const SensorSample upside_down = ideal(at_rest(turn(180.0 * kDegree, Eigen::Vector3d::UnitX())));
  EXPECT_NEAR(upside_down.imu.accel()[2], -kOneG_counts, 0.5);
}

TEST(ImuModel, TheNeedlePointsNorthAndDown) {
  // Heading east, x is east and y north: no field along x, north along y, down along -z.
  const SensorSample east = ideal(at_rest(Eigen::Matrix3d::Identity()));
  EXPECT_EQ(east.imu.mag()[0], 0);
  EXPECT_NEAR(east.imu.mag()[1] * 0.160, 520.0 * std::cos(68.0 * kDegree), 0.1);
  EXPECT_NEAR(east.imu.mag()[2] * 0.160, -520.0 * std::sin(68.0 * kDegree), 0.1);
  // Heading north, 90 degrees counter-clockwise: the field lies along x.
  const SensorSample north = ideal(at_rest(turn(90.0 * kDegree, Eigen::Vector3d::UnitZ())));
  EXPECT_NEAR(north.imu.mag()[0] * 0.160, 520.0 * std::cos(68.0 * kDegree), 0.1);
  EXPECT_NEAR(north.imu.mag()[1], 0.0, 0.5);
}

TEST(ImuModel, RatesAreQuantisedToTheNearestCount) {
  for (const double degrees_per_s : {-300.0, -0.036, -0.034, 0.0, 0.034, 0.036, 90.0, 1999.0}) {
    ImuTruth truth = at_rest(Eigen::Matrix3d::Identity());
    truth.mean_rate_rad_per_s = Eigen::Vector3d(0.0, 0.0, degrees_per_s * kDegree);
    EXPECT_NEAR(ideal(truth).imu.gyro()[2], degrees_per_s / 0.070, 0.5 + 1e-9);
  }
  ImuTruth small = at_rest(Eigen::Matrix3d::Identity());
  small.mean_rate_rad_per_s = Eigen::Vector3d(0.036, -0.036, 0.034) * kDegree;
  const SensorSample sample = ideal(small);
  EXPECT_EQ(sample.imu.gyro()[0], 1);
  EXPECT_EQ(sample.imu.gyro()[1], -1);
  EXPECT_EQ(sample.imu.gyro()[2], 0);
}

TEST(ImuModel, BeyondFullScaleItClips) {
  ImuTruth truth = at_rest(Eigen::Matrix3d::Identity());
  truth.mean_rate_rad_per_s = Eigen::Vector3d(1e6, -1e6, 0.0);
  truth.mean_specific_force = Eigen::Vector3d(20.0, -20.0, 7.9) * kGravity;
  const SensorSample sample = ideal(truth);
  EXPECT_EQ(sample.imu.gyro()[0], INT16_MAX);
  EXPECT_EQ(sample.imu.gyro()[1], INT16_MIN);
  EXPECT_EQ(sample.imu.accel()[0], INT16_MAX);  // 8 g
  EXPECT_EQ(sample.imu.accel()[1], INT16_MIN);
  EXPECT_NEAR(sample.imu.accel()[2], 7.9 * kOneG_counts, 0.5);
}

TEST(ImuModel, ChipsDeliverAtTheirOwnRates) {
  ImuModel imu(1, ImuErrors{});
  int mags = 0;
  int baros = 0;
  SensorSample sample{};
  SensorSample last{};
  for (int tick = 0; tick < 100; ++tick) {
    imu.measure(at_rest(Eigen::Matrix3d::Identity()), sample);
    EXPECT_EQ(sample.fresh & (kFreshGyro | kFreshAccel), kFreshGyro | kFreshAccel);
    if ((sample.fresh & kFreshMag) != 0) ++mags;
    if ((sample.fresh & kFreshBaro) != 0) {
      ++baros;
    } else {
      EXPECT_EQ(sample.pressure, last.pressure);  // keeps its old numbers
    }
    last = sample;
  }
  EXPECT_EQ(mags, 100) << "as hal/avr/imu.cpp sets the chip";
  EXPECT_EQ(baros, 25);
}

TEST(ImuModel, PressureFallsWithHeight) {
  ImuTruth truth = at_rest(Eigen::Matrix3d::Identity());
  EXPECT_NEAR(ideal(truth).pressure / 4096.0, 1013.25, 1e-3);
  EXPECT_NEAR(42.5 + ideal(truth).temperature / 480.0, 20.0, 0.01);
  // International barometric formula.
  truth.altitude_m = 100.0;
  EXPECT_NEAR(ideal(truth).pressure / 4096.0,
              1013.25 * std::pow(1.0 - 0.0065 * 100.0 / 288.15, 5.255), 0.1);
}

struct Moments {
  double mean;
  double sigma;
};

/// Over many samples of one axis.
template <class Get>
Moments moments(const ImuErrors& errors, Get get, uint64_t seed = 3) {
  constexpr int kSamples = 20000;
  ImuModel imu(seed, errors);
  const ImuTruth truth = at_rest(Eigen::Matrix3d::Identity());
  double sum = 0.0;
  double square = 0.0;
  int count = 0;
  for (int i = 0; i < kSamples; ++i) {
    SensorSample sample = measure(imu, truth);
    const double value = get(sample);
    if (value == 0.0 && (sample.fresh & kFreshMag) == 0) continue;  // a chip that had nothing new
    sum += value;
    square += value * value;
    ++count;
  }
  const double mean = sum / count;
  return {mean, std::sqrt(square / count - mean * mean)};
}

TEST(ImuModel, NoiseIsThatOfTheDataSheets) {
  // L3GD20H 0.011 degrees/s/sqrt(Hz), LSM303D 150 ug/sqrt(Hz) and 5 mG; 50 Hz of bandwidth.
  // Quantisation adds lsb / sqrt(12).
  const auto with_quantisation = [](double sigma, double lsb) {
    return std::hypot(sigma, lsb / std::sqrt(12.0));
  };
  ImuErrors errors = ImuErrors::none();
  errors.gyro_noise_dps = ImuErrors{}.gyro_noise_dps;
  errors.accel_noise_mg = ImuErrors{}.accel_noise_mg;
  errors.mag_noise_mgauss = ImuErrors{}.mag_noise_mgauss;
  for (int axis = 0; axis < 3; ++axis) {
    const Moments gyro = moments(
        errors, [axis](const SensorSample& s) { return s.imu.gyro()[axis] * 0.070 + 1e-12; });
    EXPECT_NEAR(gyro.sigma, with_quantisation(0.011 * std::sqrt(50.0), 0.070), 0.03 * 0.08);
    EXPECT_NEAR(gyro.mean, 0.0, 0.003);
    const Moments accel = moments(
        errors, [axis](const SensorSample& s) { return s.imu.accel()[axis] * 0.244 + 1e-12; });
    EXPECT_NEAR(accel.sigma, with_quantisation(0.150 * std::sqrt(50.0), 0.244), 0.05 * 1.06);
    EXPECT_NEAR(accel.mean, axis == 2 ? 1000.0 : 0.0, 0.05);
    const Moments mag =
        moments(errors, [axis](const SensorSample& s) { return s.imu.mag()[axis] * 0.160; });
    EXPECT_NEAR(mag.sigma, with_quantisation(5.0, 0.160), 0.03 * 5.0);
  }
}

TEST(ImuModel, BiasIsDrawnOncePerWorldWithItsSigma) {
  constexpr int kWorlds = 2000;
  ImuErrors errors = ImuErrors::none();
  errors.gyro_bias_dps = ImuErrors{}.gyro_bias_dps;
  errors.accel_bias_mg = ImuErrors{}.accel_bias_mg;
  errors.accel_scale = ImuErrors{}.accel_scale;
  const ImuTruth truth = at_rest(Eigen::Matrix3d::Identity());
  double gyro = 0.0;
  double accel_x = 0.0;
  double accel_z = 0.0;
  for (uint64_t seed = 0; seed < kWorlds; ++seed) {
    ImuModel imu(seed, errors);
    const SensorSample first = measure(imu, truth);
    const SensorSample second = measure(imu, truth);
    ASSERT_EQ(first.imu.gyro()[0], second.imu.gyro()[0]);
    ASSERT_EQ(first.imu.accel()[2], second.imu.accel()[2]);
    gyro += std::pow(first.imu.gyro()[0] * 0.070, 2);
    accel_x += std::pow(first.imu.accel()[0] * 0.244, 2);
    accel_z += std::pow(first.imu.accel()[2] * 0.244 - 1000.0, 2);
  }
  const double tolerance = 5.0 / std::sqrt(2.0 * kWorlds);
  EXPECT_NEAR(std::sqrt(gyro / kWorlds), 0.5, 0.5 * tolerance);
  EXPECT_NEAR(std::sqrt(accel_x / kWorlds), 8.0, 8.0 * tolerance);
  // Along gravity the scale error adds 0.5 % of 1 g.
  EXPECT_NEAR(std::sqrt(accel_z / kWorlds), std::hypot(8.0, 5.0), std::hypot(8.0, 5.0) * tolerance);
}

TEST(ImuModel, QuietIsExactButNotFrozen) {
  ImuModel imu(1, ImuErrors::quiet());
  const ImuTruth truth = at_rest(Eigen::Matrix3d::Identity());
  SensorSample last = measure(imu, truth);
  int same = 0;
  int longest = 0;
  for (int tick = 0; tick < 10000; ++tick) {
    const SensorSample now = measure(imu, truth);
    EXPECT_EQ(now.imu.accel()[0], 0);
    const bool repeated = now.imu.gyro()[0] == last.imu.gyro()[0] &&
                          now.imu.gyro()[1] == last.imu.gyro()[1] &&
                          now.imu.gyro()[2] == last.imu.gyro()[2];
    same = repeated ? same + 1 : 0;
    longest = std::max(longest, same);
    last = now;
  }
  EXPECT_LT(longest, 18);  // the supervisor's patience
}

TEST(ImuModel, SameSeedSameSamples) {
  ImuModel one(9, ImuErrors{});
  ImuModel two(9, ImuErrors{});
  ImuModel other(10, ImuErrors{});
  int differing = 0;
  for (int i = 0; i < 200; ++i) {
    const ImuTruth truth = at_rest(Eigen::Matrix3d::Identity());
    const SensorSample a = measure(one, truth);
    const SensorSample b = measure(two, truth);
    const SensorSample c = measure(other, truth);
    for (int axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(a.imu.gyro()[axis], b.imu.gyro()[axis]);
      ASSERT_EQ(a.imu.accel()[axis], b.imu.accel()[axis]);
      ASSERT_EQ(a.imu.mag()[axis], b.imu.mag()[axis]);
      if (a.imu.accel()[axis] != c.imu.accel()[axis]) ++differing;
    }
    ASSERT_EQ(a.pressure, b.pressure);
  }
  EXPECT_GT(differing, 300);
}

}  // namespace
}  // namespace screed
