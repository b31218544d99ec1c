// What the stand-in's ground becomes below a robot that moves as it was recorded, beside what it
// became in the physics.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "host_sim/core/task_progress.h"

namespace screed::nn {

struct GroundCheck {
  std::string source;
  double driven_s = 0.0;
  double change_mm = 0.0;  ///< RMS over the bed of the recorded change, at robot scale
  double error_mm = 0.0;   ///< RMS of the stand-in's change less the recorded one, at robot scale
  double moved_cm3 = 0.0;  ///< volume that was lowered in the recording, on the stand-in's cells
  double standin_moved_cm3 = 0.0;  ///< and in the stand-in
  std::int64_t volume_error = 0;   ///< units that the stand-in lost or made
};

/// Poses and track speeds are the recording's, from Algorithm 5's first frame on, for `seconds` or
/// to its end. Throws InputError for a session that cannot be followed (recorded_drive.h).
GroundCheck check_ground(const std::filesystem::path& session_folder, double seconds,
                         const TaskProgress& progress = {});

}  // namespace screed::nn
