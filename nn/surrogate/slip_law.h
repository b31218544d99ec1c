// Track kinematics fitted to recorded drives, frame by frame: the baselines of rollouts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "host_sim/standin/planar_pose.h"
#include "nn/surrogate/surrogate.h"

namespace screed::nn {

struct MotionFrame {
  FrameMotion motion;
  double track_left_m_per_s;  ///< at the frame's end
  double track_right_m_per_s;
  double pitch;  ///< of the ground at its beginning, as the surrogate world sees it
  double roll;
};

using MotionSeries = std::vector<MotionFrame>;

/// The frames that Algorithm 5 drove. Throws InputError, naming the folder, for a session that
/// cannot be read, has no such frames, no recorded heights, or ground of another kind than soil.
MotionSeries read_motion_series(const std::filesystem::path& session_folder);

enum class SlipLaw : std::uint8_t {
  kConstant,  ///< a share of the speed, and of the turn
  kBySlope,   ///< both, and what the slope adds; slides down sideways
  /// Instantaneous centres of rotation (J. Pentzer, S. Brennan, K. Reichard, Journal of Field
  /// Robotics 31(3), 2014): forward, sideways and turn each linear in both tracks' speeds.
  kRotationCentres,
  kRotationCentresAndSlope,
};
const char* name_of(SlipLaw law);

/// By least squares over frames. Fitted to the very drive on which it is judged, no other constants
/// of the law have less error in a frame.
TrackKinematics fitted_kinematics(SlipLaw law, std::span<const MotionSeries> series);

}  // namespace screed::nn
