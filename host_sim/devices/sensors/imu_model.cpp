// The AltIMU-10 v4: true motion in, raw counts out.
#include "host_sim/devices/sensors/imu_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host_sim/core/elementary.h"
#include "host_sim/core/gravity.h"

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

}  // namespace screed
