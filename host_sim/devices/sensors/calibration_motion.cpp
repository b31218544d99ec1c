// A person who turns the robot over.
#include "host_sim/devices/sensors/calibration_motion.h"

#include <array>
#include <cmath>
#include <numbers>

#include "hal/sample.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/gravity.h"
#include "host_sim/core/rotation.h"

namespace screed {
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
