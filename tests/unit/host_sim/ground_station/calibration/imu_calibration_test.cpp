// Calibration of an IMU: its fits, and a whole one without a radio.
#include <gtest/gtest.h>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <string>

#include "firmware/parameters/parameters.h"
#include "firmware/protocol/messages.h"
#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "host_sim/devices/sensors/imu_model.h"
#include "host_sim/ground_station/calibration/imu_calibration.h"

namespace screed {

namespace {

// The calibration's fits: known errors are found again, data that cannot tell them are refused.

Eigen::Vector3d noise(WorldRandom& random, double sigma) {
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

/// Even directions (Fibonacci), of which those with z >= least_z are kept.
std::vector<Eigen::Vector3d> directions(int count, double least_z = -1.0) {
  std::vector<Eigen::Vector3d> all;
  const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
  for (int i = 0; i < count; ++i) {
    const double z = 1.0 - 2.0 * (i + 0.5) / count;
    if (z < least_z) continue;
    const double r = std::sqrt(1.0 - z * z);
    all.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return all;
}

template <class Fit>
std::string refusal(Fit fit) {
  try {
    fit();
  } catch (const RunError& error) {
    return error.what();
  }
  return "";
}

// ---- magnetometer

/// raw = centre + soft * field * direction.
struct Ellipsoid {
  Eigen::Vector3d centre{120.0, -45.0, 230.0};
  Eigen::Matrix3d soft{{1.10, 0.04, -0.03}, {0.04, 0.93, 0.05}, {-0.03, 0.05, 1.02}};
  double field = 520.0;

  std::vector<Eigen::Vector3d> samples(const std::vector<Eigen::Vector3d>& on,
                                       double sigma = 0.0) const {
    WorldRandom random(1, "ellipsoid");
    std::vector<Eigen::Vector3d> all;
    all.reserve(on.size());
    for (const Eigen::Vector3d& direction : on)
      all.emplace_back(centre + soft * (field * direction) + noise(random, sigma));
    return all;
  }
};

TEST(EllipsoidFit, AKnownEllipsoidIsRecovered) {
  const Ellipsoid ellipsoid;
  const auto samples = ellipsoid.samples(directions(200));
  const VectorFit fit = fit_ellipsoid(samples);
  EXPECT_LT((fit.correction.offset - ellipsoid.centre).norm(), 1e-9);
  // The matrix undoes the soft iron, up to the scale, which no field of unknown strength can tell.
  const Eigen::Matrix3d product = fit.correction.matrix * ellipsoid.soft;
  const double scale = product.trace() / 3.0;
  EXPECT_LT((product / scale - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  // And the sphere has the ellipsoid's volume.
  EXPECT_NEAR(fit.radius, ellipsoid.field * std::cbrt(ellipsoid.soft.determinant()), 1e-6);
  EXPECT_GT(fit.residual_before, 0.2);
  EXPECT_LT(fit.residual_offset, fit.residual_before);
  EXPECT_GT(fit.residual_offset, 0.01);
  EXPECT_LT(fit.residual_after, 1e-7);
}

TEST(EllipsoidFit, NoiseCostsLittle) {
  const Ellipsoid ellipsoid;
  // 5 mG in 520, the LSM303D's; 120 samples are a minute at 2 Hz.
  const auto samples = ellipsoid.samples(directions(120), 5.0);
  const VectorFit fit = fit_ellipsoid(samples);
  EXPECT_LT((fit.correction.offset - ellipsoid.centre).norm(), 3.0);
  EXPECT_NEAR(fit.residual_after, 5.0 / 520.0, 0.003);
}

TEST(EllipsoidFit, ThreeQuartersOfTheSphereAreEnough) {
  const Ellipsoid ellipsoid;
  const VectorFit fit = fit_ellipsoid(ellipsoid.samples(directions(200, -0.5)));
  EXPECT_LT((fit.correction.offset - ellipsoid.centre).norm(), 1e-6);
}

TEST(EllipsoidFit, DataThatCannotTellAreRefusedInOneLine) {
  const Ellipsoid ellipsoid;
  const auto line = [](const std::vector<Eigen::Vector3d>& samples) {
    return refusal([&] { fit_ellipsoid(samples); });
  };
  // Turned on the floor alone: a plane.
  std::vector<Eigen::Vector3d> plane;
  for (Eigen::Vector3d direction : directions(200)) {
    direction.z() = 0.3;
    plane.push_back(direction);
  }
  EXPECT_NE(line(ellipsoid.samples(plane)).find("do not reach round"), std::string::npos);
  // A patch of 25 degrees.
  EXPECT_NE(line(ellipsoid.samples(directions(5000, 0.9), 5.0)).find("magnetometer: "),
            std::string::npos);
  EXPECT_NE(line(ellipsoid.samples(directions(10))).find("only 10 samples"), std::string::npos);
  EXPECT_NE(line(std::vector<Eigen::Vector3d>(50, Eigen::Vector3d(1, 2, 3))).find("the same"),
            std::string::npos);
  // A hyperboloid.
  std::vector<Eigen::Vector3d> saddle;
  for (const Eigen::Vector3d& direction : directions(300)) {
    const double z = direction.z() * 2.0;
    const double r = std::sqrt(1.0 + z * z);
    const double along = std::hypot(direction.x(), direction.y());
    saddle.emplace_back(r * direction.x() / along, r * direction.y() / along, z);
  }
  EXPECT_NE(line(saddle).find("no ellipsoid"), std::string::npos);
}

TEST(EllipsoidFit, CoverageIsTheShareOfDirections) {
  EXPECT_DOUBLE_EQ(coverage(directions(2000), Eigen::Vector3d::Zero()), 1.0);
  EXPECT_DOUBLE_EQ(coverage({}, Eigen::Vector3d::Zero()), 0.0);
  const std::vector<Eigen::Vector3d> one = {{0.0, 0.0, 3.0}};
  EXPECT_DOUBLE_EQ(coverage(one, Eigen::Vector3d::Zero()), 1.0 / 26.0);
}

// ---- accelerometer

std::array<Eigen::Vector3d, kPositions> positions_held(const Eigen::Vector3d& offset,
                                                       const Eigen::Vector3d& scale,
                                                       double sloppiness) {
  const std::array<Eigen::Vector3d, kPositions> up = {
      Eigen::Vector3d{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  WorldRandom random(2, "positions");
  std::array<Eigen::Vector3d, kPositions> forces;
  for (size_t i = 0; i < kPositions; ++i) {
    const Eigen::Vector3d held = (up.at(i) + noise(random, sloppiness)).normalized();
    forces.at(i) = (1000.0 * held).cwiseQuotient(scale) + offset;
  }
  return forces;
}

TEST(AccelerometerFit, KnownErrorsAreRecoveredThoughThePositionsAreSloppy) {
  const Eigen::Vector3d offset(55.0, -40.0, 20.0);
  const Eigen::Vector3d scale(1.02, 0.985, 1.01);
  const VectorFit fit = fit_accelerometer(positions_held(offset, scale, 0.08), 1000.0);
  EXPECT_LT((fit.correction.offset - offset).norm(), 1e-6);
  EXPECT_LT((fit.correction.matrix.diagonal() - scale).norm(), 1e-9);
  EXPECT_GT(fit.residual_before, 0.02);
  EXPECT_LT(fit.residual_after, 1e-7);
}

TEST(AccelerometerFit, WrongPositionsAndBrokenSensorsAreRefused) {
  auto forces = positions_held(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), 0.0);
  std::swap(forces[2], forces[3]);
  EXPECT_NE(refusal([&] { fit_accelerometer(forces, 1000.0); }).find("'nose up' was not held"),
            std::string::npos);
  const auto far = positions_held({0.0, 0.0, 400.0}, Eigen::Vector3d::Ones(), 0.0);
  EXPECT_NE(refusal([&] { fit_accelerometer(far, 1000.0); }).find("errors above 20 %"),
            std::string::npos);
}

TEST(AccelerometerFit, PositionsAreKnownByWhatPointsUp) {
  EXPECT_EQ(position_of({0.0, 100.0, 990.0}), Position::kLevel);
  EXPECT_EQ(position_of({-980.0, 100.0, 0.0}), Position::kNoseDown);
  EXPECT_EQ(position_of({0.0, 1.0, 0.2}), Position::kLeftUp);
  EXPECT_FALSE(position_of({700.0, 0.0, 700.0}).has_value());
  EXPECT_FALSE(position_of(Eigen::Vector3d::Zero()).has_value());
}

// ---- gyro

TEST(GyroFit, TheBiasIsTheMeanAtRest) {
  WorldRandom random(3, "gyro");
  std::vector<Eigen::Vector3d> samples;
  samples.reserve(400);
  const Eigen::Vector3d bias(0.6, -1.2, 0.3);
  for (int i = 0; i < 400; ++i) samples.emplace_back(bias + noise(random, 0.08));
  const GyroFit fit = fit_gyro(samples, 0.5);
  EXPECT_LT((fit.bias - bias).norm(), 0.02);
  EXPECT_NEAR(fit.deviation.x(), 0.08, 0.01);
  samples[200].x() += 30.0;
  EXPECT_NE(refusal([&] { fit_gyro(samples, 0.5); }).find("was moved"), std::string::npos);
  samples.resize(5);
  EXPECT_NE(refusal([&] { fit_gyro(samples, 0.5); }).find("only 5 samples"), std::string::npos);
}

// A whole calibration without a radio: the simulated IMU in the simulated person's hands.

template <class Message>
CanFrame frame_with(const int16_t (&counts)[3]) {
  Message message{};
  message.x = counts[0];
  message.y = counts[1];
  message.z = counts[2];
  return frame_of(message);
}

/// Frames as a robot sends them: accelerometer and gyro ten times a second, magnetometer twice.
void hold(ImuModel& imu, double from_s, double to_s, ImuCollector& collector) {
  SensorSample sample{};
  for (int tick = static_cast<int>(from_s * kTickRate_hz); tick < to_s * kTickRate_hz; ++tick) {
    imu.measure(calibration_motion(static_cast<double>(tick) / kTickRate_hz), sample);
    if (tick % 10 == 0) collector.add_frame(frame_with<message::AccelRaw>(sample.imu.accel()));
    if (tick % 10 == 5) collector.add_frame(frame_with<message::GyroRaw>(sample.imu.gyro()));
    if (tick % 50 == 0) collector.add_frame(frame_with<message::MagRaw>(sample.imu.mag()));
  }
}

ImuTruth level_at_rest() {
  ImuTruth truth;
  truth.mean_rate_rad_per_s = Eigen::Vector3d::Zero();
  truth.mean_specific_force = {0.0, 0.0, kGravity_m_per_s2};
  truth.body_to_world = Eigen::Matrix3d::Identity();
  truth.altitude_m = 0.0;
  return truth;
}

TEST(Handling, TheMotionIsOneThatABodyCanMake) {
  for (double t = 0.02; t < kCalibrationMotionPeriod_s + 1.0; t += 0.37) {
    const ImuTruth now = calibration_motion(t);
    const ImuTruth before = calibration_motion(t - 0.01);
    EXPECT_NEAR(now.mean_specific_force.norm(), kGravity_m_per_s2, 1e-9);
    // Nobody turns a robot faster than the gyro can say.
    EXPECT_LT(now.mean_rate_rad_per_s.norm(), 10.0);
    // Rate and attitude belong together.
    const Eigen::Vector3d turn = now.mean_rate_rad_per_s * 0.01;
    const Eigen::Matrix3d expected =
        before.body_to_world *
        Eigen::AngleAxisd(turn.norm(), turn.norm() > 0.0 ? Eigen::Vector3d(turn.normalized())
                                                         : Eigen::Vector3d(1.0, 0.0, 0.0))
            .toRotationMatrix();
    EXPECT_LT((expected - now.body_to_world).norm(), 1e-6) << t;
  }
}

TEST(ImuCollector, ARobotInTheHandIsCalibrated) {
  for (const uint64_t seed : {1ULL, 2ULL, 3ULL}) {
    ImuModel imu(seed, ImuErrors::uncalibrated());
    ImuCollector collector;
    EXPECT_NE(collector.advice().find("level"), std::string::npos);
    hold(imu, 0.0, 56.0, collector);
    EXPECT_TRUE(collector.positions_done()) << collector.advice();
    EXPECT_FALSE(collector.complete());
    EXPECT_NE(collector.advice().find("all directions"), std::string::npos);
    hold(imu, 56.0, kCalibrationMotionPeriod_s, collector);
    ASSERT_TRUE(collector.complete()) << collector.mag_coverage();
    const ImuCalibration found = collector.fit();

    // What the sensors say at rest, level, is what the calibration says of them.
    constexpr int kMeasurements = 2000;
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (int i = 0; i < kMeasurements; ++i) {
      rate += imu.gyro_dps(level_at_rest()) / kMeasurements;
      force += imu.accel_mg(level_at_rest()) / kMeasurements;
    }
    EXPECT_LT((found.gyro.bias * 0.070 - rate).norm(), 0.05);
    const Eigen::Vector3d corrected = found.accelerometer.correction.apply(force / 0.244) * 0.244;
    EXPECT_LT((corrected - Eigen::Vector3d(0.0, 0.0, 1000.0)).norm(), 6.0);

    EXPECT_GT(found.accelerometer.residual_before, 0.01);
    EXPECT_LT(found.accelerometer.residual_after, 0.001);
    EXPECT_GT(found.magnetometer.residual_before, 0.05);
    EXPECT_LT(found.magnetometer.residual_offset, found.magnetometer.residual_before);
    EXPECT_LT(found.magnetometer.residual_after, 0.013);  // 5 mG of noise in 520

    // Every parameter is one that the robot has, and lies in its range.
    for (const CalibrationParameter& parameter : calibration_parameters(found)) {
      bool known = false;
      for (const ParameterInfo& info : kParameterTable) {
        if (parameter.name != info.name) continue;
        known = parameter.value >= info.min && parameter.value <= info.max;
      }
      EXPECT_TRUE(known) << parameter.name << " = " << parameter.value;
    }
  }
}

TEST(ImuCollector, ARobotThatIsNeverStillIsNotCalibrated) {
  ImuModel imu(1, ImuErrors::uncalibrated());
  ImuCollector collector;
  hold(imu, 60.0, kCalibrationMotionPeriod_s, collector);
  EXPECT_FALSE(collector.complete());
  EXPECT_THROW(static_cast<void>(collector.fit()), RunError);
}

TEST(ImuCollector, ProgressNeverFallsAndIsEnoughOnlyAtTheEnd) {
  for (const uint64_t seed : {1ULL, 2ULL, 3ULL}) {
    ImuModel imu(seed, ImuErrors::uncalibrated());
    ImuCollector collector;
    double before = 0.0;
    for (double t = 0.0; t < kCalibrationMotionPeriod_s; t += 0.5) {
      hold(imu, t, t + 0.5, collector);
      const double now = collector.mag_coverage();
      EXPECT_GE(now, before) << "seed " << seed << ", " << t << " s";
      // A robot that stands where it stood has been turned nowhere.
      if (t < 4.0) {
        EXPECT_LT(now, 0.05) << t;
      }
      if (t < 56.0) {
        EXPECT_LT(now, ImuCollector::kEnoughCoverage) << t;
      }
      before = now;
    }
    EXPECT_TRUE(collector.complete());
    EXPECT_GE(before, ImuCollector::kEnoughCoverage);
  }
}

}  // namespace

}  // namespace screed
