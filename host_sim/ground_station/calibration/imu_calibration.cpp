// Fits of IMU errors.
#include "host_sim/ground_station/calibration/imu_calibration.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdio>
#include <string>

#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"

namespace screed {

namespace {

constexpr size_t kMinSamples = 20;
/// Ratio of the singular values below which the samples leave a parameter open: 0.31 all round,
/// 0.06 of half a sphere, 0.024 of a quarter of its surface.
constexpr double kMinRank = 0.03;
/// Longest to shortest axis of an ellipsoid that a magnetometer can show.
constexpr double kMaxAxisRatio = 3.0;
/// What an accelerometer may be wrong by: the LSM303D's 60 mg and some.
constexpr double kMaxAccelError = 0.2;
constexpr double kPositionCosine = 0.866;  // 30 degrees

std::string percent(double share) {
  char text[24];
  std::snprintf(text, sizeof text, "%.0f %%", share * 100.0);
  return text;
}

double relative_deviation(std::span<const Eigen::Vector3d> samples,
                          const VectorCorrection& correction) {
  double sum = 0.0;
  double squares = 0.0;
  for (const Eigen::Vector3d& sample : samples) {
    const double length = correction.apply(sample).norm();
    sum += length;
    squares += length * length;
  }
  const auto count = static_cast<double>(samples.size());
  const double mean = sum / count;
  return std::sqrt(std::max(squares / count - mean * mean, 0.0)) / mean;
}

void fill_residuals(std::span<const Eigen::Vector3d> samples, VectorFit& fit) {
  fit.residual_before = relative_deviation(samples, {});
  fit.residual_offset =
      relative_deviation(samples, {fit.correction.offset, Eigen::Matrix3d::Identity()});
  fit.residual_after = relative_deviation(samples, fit.correction);
}

constexpr std::array<const char*, kPositions> kPositionNames = {
    "level", "upside down", "nose up", "nose down", "left side up", "right side up"};

/// At rest the specific force points up: this axis of the robot does.
Eigen::Vector3d up_in(Position position) {
  switch (position) {
    case Position::kLevel:
      return Eigen::Vector3d::UnitZ();
    case Position::kUpsideDown:
      return -Eigen::Vector3d::UnitZ();
    case Position::kNoseUp:
      return Eigen::Vector3d::UnitX();
    case Position::kNoseDown:
      return -Eigen::Vector3d::UnitX();
    case Position::kLeftUp:
      return Eigen::Vector3d::UnitY();
    case Position::kRightUp:
      break;
  }
  return -Eigen::Vector3d::UnitY();
}

}  // namespace

const char* position_name(Position position) {
  return kPositionNames.at(static_cast<size_t>(position));
}

std::optional<Position> position_of(const Eigen::Vector3d& force) {
  for (size_t i = 0; i < kPositions; ++i) {
    const auto position = static_cast<Position>(i);
    if (force.dot(up_in(position)) > kPositionCosine * force.norm()) return position;
  }
  return std::nullopt;
}

GyroFit fit_gyro(std::span<const Eigen::Vector3d> samples, double max_deviation) {
  if (samples.size() < kMinSamples) {
    throw RunError("gyro: only " + std::to_string(samples.size()) + " samples at rest; " +
                   std::to_string(kMinSamples) + " are needed");
  }
  GyroFit fit;
  for (const Eigen::Vector3d& sample : samples) fit.bias += sample;
  fit.bias /= static_cast<double>(samples.size());
  for (const Eigen::Vector3d& sample : samples) fit.deviation += (sample - fit.bias).cwiseAbs2();
  fit.deviation = (fit.deviation / static_cast<double>(samples.size())).cwiseSqrt();
  if (fit.deviation.maxCoeff() > max_deviation)
    throw RunError("gyro: the robot was moved; put it down and let go of it");
  return fit;
}

VectorFit fit_accelerometer(const std::array<Eigen::Vector3d, kPositions>& forces, double gravity) {
  for (size_t i = 0; i < kPositions; ++i) {
    if (position_of(forces.at(i)) != static_cast<Position>(i)) {
      throw RunError(std::string("accelerometer: '") + kPositionNames.at(i) +
                     "' was not held in that position");
    }
  }
  // Unknown: offset o and scale s of each axis, |s (f - o)| = gravity.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  for (int iteration = 0; iteration < 20; ++iteration) {
    Eigen::Matrix<double, kPositions, 6> jacobian;
    Eigen::Matrix<double, kPositions, 1> error;
    for (size_t i = 0; i < kPositions; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const Eigen::Vector3d& force = forces.at(i);
      const Eigen::Vector3d corrected = scale.cwiseProduct(force - offset);
      const double length = corrected.norm();
      error[row] = length - gravity;
      jacobian.row(row).head<3>() = -corrected.cwiseProduct(scale) / length;
      jacobian.row(row).tail<3>() = corrected.cwiseProduct(force - offset) / length;
    }
    const Eigen::Matrix<double, 6, 1> step = jacobian.colPivHouseholderQr().solve(error);
    offset -= step.head<3>();
    scale -= step.tail<3>();
    if (step.head<3>().norm() < 1e-9 * gravity) break;
  }
  if (!offset.allFinite() || !scale.allFinite() ||
      offset.cwiseAbs().maxCoeff() > kMaxAccelError * gravity ||
      (scale - Eigen::Vector3d::Ones()).cwiseAbs().maxCoeff() > kMaxAccelError) {
    throw RunError("accelerometer: errors above " + percent(kMaxAccelError) +
                   " of gravity; hold the robot still in each position, and look at the sensor");
  }
  VectorFit fit;
  fit.correction.offset = offset;
  fit.correction.matrix = scale.asDiagonal();
  fit.radius = gravity;
  fill_residuals(forces, fit);
  return fit;
}

VectorFit fit_ellipsoid(std::span<const Eigen::Vector3d> samples) {
  if (samples.size() < kMinSamples) {
    throw RunError("magnetometer: only " + std::to_string(samples.size()) + " samples; " +
                   std::to_string(kMinSamples) + " are needed");
  }
  const auto count = static_cast<Eigen::Index>(samples.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& sample : samples) mean += sample / static_cast<double>(count);
  double size = 0.0;
  for (const Eigen::Vector3d& sample : samples) size = std::max(size, (sample - mean).norm());
  if (size <= 1e-6 * mean.norm()) throw RunError("magnetometer: it always says the same");

  // p' A p + 2 b' p = 1 of points p about their mean, in their size: linear in A and b.
  Eigen::MatrixXd design(count, 9);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d p = (samples[static_cast<size_t>(i)] - mean) / size;
    design.row(i) << p.x() * p.x(), p.y() * p.y(), p.z() * p.z(), 2.0 * p.x() * p.y(),
        2.0 * p.x() * p.z(), 2.0 * p.y() * p.z(), 2.0 * p.x(), 2.0 * p.y(), 2.0 * p.z();
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(design, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& singular = svd.singularValues();
  if (singular[8] < kMinRank * singular[0])
    throw RunError(
        "magnetometer: the samples do not reach round; turn the robot about all its axes");
  const Eigen::VectorXd v = svd.solve(Eigen::VectorXd::Ones(count));
  Eigen::Matrix3d quadratic;
  quadratic << v[0], v[3], v[4], v[3], v[1], v[5], v[4], v[5], v[2];
  const Eigen::Vector3d linear(v[6], v[7], v[8]);

  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> shape(quadratic);
  const Eigen::Vector3d& curvature = shape.eigenvalues();
  if (curvature[0] <= 0.0 || curvature[2] > kMaxAxisRatio * kMaxAxisRatio * curvature[0]) {
    throw RunError(
        "magnetometer: the samples lie on no ellipsoid; turn the robot about all its axes, away "
        "from iron");
  }
  const Eigen::Vector3d centre = -quadratic.ldlt().solve(linear);
  const double level = 1.0 + centre.dot(quadratic * centre);
  // (p - c)' (A / level) (p - c) = 1: the root of A makes a unit sphere of it.
  const Eigen::Matrix3d to_sphere = shape.eigenvectors() *
                                    (curvature / level).cwiseSqrt().asDiagonal() *
                                    shape.eigenvectors().transpose();
  // The radius of the sphere with the ellipsoid's volume.
  const double radius = size / std::cbrt(to_sphere.determinant());

  VectorFit fit;
  fit.correction.offset = mean + size * centre;
  fit.correction.matrix = to_sphere * (radius / size);
  fit.radius = radius;
  fill_residuals(samples, fit);
  return fit;
}

double coverage(std::span<const Eigen::Vector3d> samples, const Eigen::Vector3d& centre) {
  // The directions of a cube's faces, edges and corners.
  std::vector<Eigen::Vector3d> patches;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) patches.push_back(Eigen::Vector3d(x, y, z).normalized());
      }
    }
  }
  std::bitset<26> seen;
  for (const Eigen::Vector3d& sample : samples) {
    const Eigen::Vector3d direction = (sample - centre).normalized();
    const auto nearest = std::max_element(patches.begin(), patches.end(),
                                          [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
                                            return a.dot(direction) < b.dot(direction);
                                          });
    seen.set(static_cast<size_t>(nearest - patches.begin()));
  }
  return static_cast<double>(seen.count()) / static_cast<double>(patches.size());
}

// Collecting the data of a calibration.

namespace {

// Counts: 70 mdps, 0.244 mg (hal/sample.h).
constexpr double kGravity_counts = 1000.0 / 0.244;
constexpr double kStillGyro_counts = 1.5 / 0.070;  // peak to peak; noise at rest has 0.5 degrees/s
constexpr double kStillAccel_counts = 25.0 / 0.244;
constexpr double kStillDeviation_counts = 0.5 / 0.070;
constexpr size_t kRecent = 8;  // 0.8 s
// What the samples of a whole turn reach on each axis at least: 350 mG of the 440 that the weakest
// field of the earth, 220 mG, gives. The middle of samples that reach less lies among them, and
// they would seem to be all round it.
constexpr double kMinMagExtent_counts = 350.0 / 0.160;
constexpr size_t kMaxSamples = 5000;

template <class Message>
Eigen::Vector3d vector_of(const CanFrame& frame) {
  const auto message = Message::unpack(frame.data);
  return {static_cast<double>(message.x), static_cast<double>(message.y),
          static_cast<double>(message.z)};
}

double spread(const std::deque<Eigen::Vector3d>& samples) {
  Eigen::Vector3d least = samples.front();
  Eigen::Vector3d most = samples.front();
  for (const Eigen::Vector3d& sample : samples) {
    least = least.cwiseMin(sample);
    most = most.cwiseMax(sample);
  }
  return (most - least).maxCoeff();
}

void keep_recent(std::deque<Eigen::Vector3d>& samples, const Eigen::Vector3d& sample) {
  samples.push_back(sample);
  if (samples.size() > kRecent) samples.pop_front();
}

int16_t counts(double value) {
  return static_cast<int16_t>(std::clamp(std::lround(value), -32767L, 32767L));
}

}  // namespace

std::vector<CalibrationParameter> calibration_parameters(const ImuCalibration& calibration) {
  std::vector<CalibrationParameter> parameters;
  const auto add = [&](const std::string& name, const Eigen::Vector3d& vector) {
    for (int i = 0; i < 3; ++i) parameters.push_back({name + "_" + "xyz"[i], counts(vector[i])});
  };
  add("gyro_offset", calibration.gyro.bias);
  add("accel_offset", calibration.accelerometer.correction.offset);
  add("mag_offset", calibration.magnetometer.correction.offset);
  return parameters;
}

void ImuCollector::add_frame(const CanFrame& frame) {
  const uint16_t id = id_of_node(frame.id, 1);
  if (id == kIdMagRaw) {
    add_mag(vector_of<message::MagRaw>(frame));
  } else if (id == kIdGyroRaw) {
    keep_recent(recent_gyro_, vector_of<message::GyroRaw>(frame));
    // The oldest of the window: what came after it was still as well.
    if (at_rest() && rest_gyro_.size() < kMaxSamples) rest_gyro_.push_back(recent_gyro_.front());
  } else if (id == kIdAccelRaw) {
    keep_recent(recent_accel_, vector_of<message::AccelRaw>(frame));
    const bool still = recent_gyro_.size() == kRecent && recent_accel_.size() == kRecent &&
                       spread(recent_gyro_) < kStillGyro_counts &&
                       spread(recent_accel_) < kStillAccel_counts;
    still_ = still ? still_ + 1 : 0;
    const Eigen::Vector3d& force = recent_accel_.front();
    const std::optional<Position> held = position_of(force);
    if (!at_rest() || !held.has_value()) return;
    Rest& rest = rests_.at(static_cast<size_t>(*held));
    rest.sum += force;
    ++rest.count;
  }
}

std::optional<Position> ImuCollector::position() const {
  if (recent_accel_.empty()) return std::nullopt;
  return position_of(recent_accel_.back());
}

bool ImuCollector::positions_done() const {
  return std::all_of(rests_.begin(), rests_.end(),
                     [](const Rest& rest) { return rest.count >= kRestSamples; });
}

void ImuCollector::add_mag(const Eigen::Vector3d& sample) {
  if (mag_.size() >= kMaxSamples) return;
  mag_.push_back(sample);
  least_mag_ = mag_.size() == 1 ? sample : Eigen::Vector3d(least_mag_.cwiseMin(sample));
  most_mag_ = mag_.size() == 1 ? sample : Eigen::Vector3d(most_mag_.cwiseMax(sample));
  const Eigen::Vector3d extent = most_mag_ - least_mag_;
  const double reached = std::min(extent.minCoeff() / kMinMagExtent_counts, 1.0);
  const double seen = coverage(mag_, 0.5 * (least_mag_ + most_mag_));
  const bool enough = reached == 1.0 && seen >= kEnoughCoverage && mag_.size() >= kEnoughMagSamples;
  const double now = enough ? seen : std::min(reached * seen, kEnoughCoverage - 0.01);
  mag_coverage_ = std::max(mag_coverage_, now);
}

bool ImuCollector::complete() const {
  return positions_done() && mag_coverage() >= kEnoughCoverage;
}

ImuCalibration ImuCollector::fit() const {
  std::array<Eigen::Vector3d, kPositions> forces;
  for (size_t i = 0; i < kPositions; ++i) {
    const Rest& rest = rests_.at(i);
    if (rest.count == 0) {
      throw RunError(std::string("accelerometer: the robot was never still in the position '") +
                     position_name(static_cast<Position>(i)) + "'");
    }
    forces.at(i) = rest.sum / static_cast<double>(rest.count);
  }
  ImuCalibration calibration;
  calibration.gyro = fit_gyro(rest_gyro_, kStillDeviation_counts);
  calibration.accelerometer = fit_accelerometer(forces, kGravity_counts);
  calibration.magnetometer = fit_ellipsoid(mag_);
  return calibration;
}

std::string ImuCollector::advice() const {
  const std::optional<Position> held = position();
  if (held.has_value() && !position_done(*held))
    return std::string("hold still: ") + position_name(*held);
  for (size_t i = 0; i < kPositions; ++i) {
    const auto position = static_cast<Position>(i);
    if (!position_done(position))
      return std::string("turn the robot ") + position_name(position) + " and hold it still";
  }
  if (!complete()) return "turn the robot slowly through all directions, away from iron";
  return "done: put the robot down, level";
}

}  // namespace screed
