// Collecting the data of a calibration.
#include "host_sim/ground_station/calibration/imu_collector.h"

#include <algorithm>
#include <cmath>

#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"

namespace screed {
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
