// The calibration's fits: known errors are found again, data that cannot tell them are refused.
#include "host_sim/ground_station/calibration/imu_fit.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include <cmath>
#include <numbers>
#include <string>

#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"

namespace screed {
namespace {

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

}  // namespace
}  // namespace screed
