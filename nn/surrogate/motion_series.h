// What a recorded session says of its robot's motion, frame by frame: what baselines are fitted to.
#pragma once

#include <filesystem>
#include <vector>

#include "host_sim/standin/planar_pose.h"

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

}  // namespace screed::nn
