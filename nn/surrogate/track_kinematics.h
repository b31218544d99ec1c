// Motion from track speeds and the ground's slope by constants, without a state: what anything that
// stands in for the physics must beat.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "host_sim/standin/planar_pose.h"

namespace screed::nn {

/// Forward, sideways and turn of a frame are linear in these.
enum class TrackInput : std::uint8_t {
  kLeft,      ///< speed of the left track, m/s
  kRight,     ///< of the right one
  kClimb,     ///< magnitude of their mean times the pitch: slip grows uphill
  kLean,      ///< magnitude of their mean times the roll: what slides down sideways
  kLeanAhead  ///< their mean, signed, times the roll: turns its nose downhill
};
inline constexpr int kTrackInputs = 5;

using TrackInputs = Eigen::Matrix<double, kTrackInputs, 1>;
/// Speeds in m/s, pitch and roll of the ground in rad, nose and left side up positive.
TrackInputs track_inputs(double left_m_per_s, double right_m_per_s, double pitch, double roll);

struct TrackKinematics {
  Eigen::Matrix<double, 3, kTrackInputs> per_second =
      Eigen::Matrix<double, 3, kTrackInputs>::Zero();

  FrameMotion motion(double left_m_per_s, double right_m_per_s, double pitch, double roll) const;
};

/// The robot goes as its tracks do: `speed_share` of their mean speed, and turns as if they were
/// `tread_m` apart. No slip: 1 and the robot's own tread.
TrackKinematics skid_kinematics(double speed_share, double tread_m);

}  // namespace screed::nn
