// What a recorded session says of its robot's motion, frame by frame: the material that networks of
// motion learn from and that rollouts are compared with.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host_sim/physics/soil/soil_parameters.h"
#include "nn/surrogate/surrogate.h"

namespace screed::nn {

struct MotionFrame {
  FrameMotion motion;
  double track_left_m_per_s;  ///< at the frame's end
  double track_right_m_per_s;
  double pitch;  ///< of the ground at its beginning, as the surrogate world sees it
  double roll;
  PlanarPose pose;  ///< at its end; places as travelled, beyond the bed's edges
};

struct MotionSeries {
  std::string source;        ///< name of the session
  std::string content_hash;  ///< of the session
  SoilParameters soil;
  std::uint64_t first = 0;  ///< row of the session that frames[0] is
  std::vector<MotionFrame> frames;
};

/// The frames that Algorithm 5 drove. Throws InputError, naming the folder, for a session that
/// cannot be read, has no such frames, no recorded heights, or ground of another kind than soil.
MotionSeries read_motion_series(const std::filesystem::path& session_folder);

}  // namespace screed::nn
