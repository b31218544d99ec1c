// The AltIMU-10 v4: true motion in, raw counts out.
#include "host_sim/devices/sensors/imu_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/rotation.h"

namespace screed {

namespace {

constexpr double kGyroLsb_dps = 0.070;
constexpr double kAccelLsb_mg = 0.244;
constexpr double kMagLsb_mgauss = 0.160;
constexpr uint32_t kBaroTicks = 4;

Eigen::Vector3d normals(WorldRandom& random, double sigma) {
  // One after another: the order of draws is part of the result.
  const double x = random.normal();
  const double y = random.normal();
  const double z = random.normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

/// Symmetric, about 1.
Eigen::Matrix3d soft_iron(uint64_t seed, double sigma) {
  WorldRandom random(seed, "soft iron");
  const Eigen::Vector3d along = normals(random, sigma);
  const Eigen::Vector3d across = normals(random, sigma);
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();
  matrix.diagonal() += along;
  matrix(0, 1) = matrix(1, 0) = across.x();
  matrix(0, 2) = matrix(2, 0) = across.y();
  matrix(1, 2) = matrix(2, 1) = across.z();
  return matrix;
}

}  // namespace

int16_t ImuModel::quantise(double value, double lsb) {
  return static_cast<int16_t>(std::clamp(std::round(value / lsb), -32768.0, 32767.0));
}

ImuModel::ImuModel(uint64_t seed, const ImuErrors& errors)
    : errors_(errors),
      gyro_random_(seed, "gyro"),
      accel_random_(seed, "accelerometer"),
      mag_random_(seed, "magnetometer"),
      baro_random_(seed, "barometer"),
      gyro_bias_dps_(normals(gyro_random_, errors.gyro_bias_dps)),
      gyro_scale_(Eigen::Vector3d::Ones() + normals(gyro_random_, errors.gyro_scale)),
      accel_bias_mg_(normals(accel_random_, errors.accel_bias_mg)),
      accel_scale_(Eigen::Vector3d::Ones() + normals(accel_random_, errors.accel_scale)),
      mag_bias_mgauss_(normals(mag_random_, errors.mag_bias_mgauss)),
      mag_soft_iron_(soft_iron(seed, errors.mag_soft_iron)),
      pressure_bias_hpa_(errors.pressure_bias_hpa * baro_random_.normal()) {}

Eigen::Vector3d ImuModel::earth_field_gauss() {
  constexpr double kField_gauss = 0.52;
  constexpr double kInclination = 68.0 * std::numbers::pi / 180.0;
  return {0.0, kField_gauss * portable::cos(kInclination),
          -kField_gauss * portable::sin(kInclination)};
}

Eigen::Vector3d ImuModel::gyro_dps(const ImuTruth& truth) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  return (truth.mean_rate_rad_per_s * kDegrees).cwiseProduct(gyro_scale_) + gyro_bias_dps_ +
         normals(gyro_random_, errors_.gyro_noise_dps);
}

Eigen::Vector3d ImuModel::accel_mg(const ImuTruth& truth) {
  return (truth.mean_specific_force * (1000.0 / kGravity_m_per_s2)).cwiseProduct(accel_scale_) +
         accel_bias_mg_ + normals(accel_random_, errors_.accel_noise_mg);
}

Eigen::Vector3d ImuModel::mag_mgauss(const ImuTruth& truth) {
  const Eigen::Vector3d field = truth.body_to_world.transpose() * (earth_field_gauss() * 1000.0);
  return mag_soft_iron_ * field + mag_bias_mgauss_ + normals(mag_random_, errors_.mag_noise_mgauss);
}

double ImuModel::pressure_hpa(const ImuTruth& truth) {
  // 1013.25 hPa at height 0; 0.12 hPa a metre near the ground (barometric formula, linearised).
  return 1013.25 - 0.1201 * truth.altitude_m + pressure_bias_hpa_ +
         errors_.pressure_noise_hpa * baro_random_.normal();
}

void ImuModel::measure(const ImuTruth& truth, SensorSample& sample) {
  const Eigen::Vector3d gyro = gyro_dps(truth);
  const Eigen::Vector3d accel = accel_mg(truth);
  const Eigen::Vector3d mag = mag_mgauss(truth);
  for (int i = 0; i < 3; ++i) {
    sample.imu.gyro()[i] = quantise(gyro[i], kGyroLsb_dps);
    sample.imu.accel()[i] = quantise(accel[i], kAccelLsb_mg);
    sample.imu.mag()[i] = quantise(mag[i], kMagLsb_mgauss);
  }
  sample.fresh = kFreshGyro | kFreshAccel | kFreshMag;
  if (ticks_ % kBaroTicks == 0) {
    sample.pressure = static_cast<int32_t>(std::lround(pressure_hpa(truth) * 4096.0));
    sample.temperature = static_cast<int16_t>(std::lround((kTemperature_degc - 42.5) * 480.0));
    sample.fresh |= kFreshBaro;
  }
  ++ticks_;
}

// A person who turns the robot over.

namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kHalfTurn = std::numbers::pi;
constexpr double kHold_s = 5.0;
constexpr double kTurn_s = 2.0;
constexpr double kTumble_s = 70.0;
// Fast about the vertical, slowly over the nose: the field passes all directions of the robot.
constexpr double kTumbleYaw = 40.0 * kHalfTurn / 180.0;
constexpr double kTumblePitch = 360.0 / kTumble_s * kHalfTurn / 180.0;

/// Held in turn: level, nose up, nose down, left and right side up, upside down, level. Pitch is
/// nose up positive; a turn about y lowers the nose.
const std::array<Quaterniond, 8>& positions() {
  static const std::array<Quaterniond, 8> kHeld = {
      Quaterniond::Identity(),
      rotation_about(Vector3d::UnitY(), -kHalfTurn / 2.0),
      rotation_about(Vector3d::UnitY(), kHalfTurn / 2.0),
      rotation_about(Vector3d::UnitX(), kHalfTurn / 2.0),
      rotation_about(Vector3d::UnitX(), -kHalfTurn / 2.0),
      rotation_about(Vector3d::UnitX(), 0.98 * kHalfTurn),
      Quaterniond::Identity(),
      Quaterniond::Identity()};
  return kHeld;
}
constexpr double kStep_s = kHold_s + kTurn_s;
static_assert(kCalibrationMotionPeriod_s == 8 * kStep_s + kTumble_s);

Quaterniond attitude_at(double time_s) {
  const double t =
      time_s - kCalibrationMotionPeriod_s * std::floor(time_s / kCalibrationMotionPeriod_s);
  const double tumble_s = t - 8 * kStep_s;
  if (tumble_s >= 0.0) {
    return rotation_about(Vector3d::UnitZ(), kTumbleYaw * tumble_s) *
           rotation_about(Vector3d::UnitY(), kTumblePitch * tumble_s);
  }
  const auto step = static_cast<size_t>(t / kStep_s);
  const double turning_s = t - static_cast<double>(step) * kStep_s - kHold_s;
  const Quaterniond& now = positions().at(step);
  if (turning_s <= 0.0) return now;
  const double share = 0.5 - 0.5 * portable::cos(kHalfTurn * turning_s / kTurn_s);
  const Quaterniond& next = positions().at(std::min<size_t>(step + 1, 7));
  const Vector3d turn = rotation_vector(now.conjugate() * next);
  const double angle_rad = turn.norm();
  return angle_rad == 0.0 ? now : now * rotation_about(turn / angle_rad, share * angle_rad);
}

}  // namespace

ImuTruth calibration_motion(double time_s) {
  const Quaterniond before = attitude_at(time_s - kTick_s);
  const Quaterniond after = attitude_at(time_s);
  ImuTruth truth;
  truth.mean_rate_rad_per_s = rotation_vector(before.conjugate() * after) / kTick_s;
  truth.mean_specific_force = after.conjugate() * Vector3d(0.0, 0.0, kGravity_m_per_s2);
  truth.body_to_world = after.toRotationMatrix();
  truth.altitude_m = 0.5;
  return truth;
}

}  // namespace screed
