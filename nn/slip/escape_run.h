// Drives into a trap until the robot's slip watch says stuck, and what gets the robot out from
// there: nothing, the firmware's escape, or the best of a list of manoeuvres.
//
// All trials of a stuck robot are the same drive up to the moment of the alarm, to the bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "nn/slip/slip_drive.h"

namespace screed::nn {

/// The trapped drive of this seed (slip_drive.h) by an algorithm that may escape: where the
/// ground station would drive, the random walk with that speed, straight on or in arcs.
StuckScenario escape_scenario(std::uint64_t seed);

/// Out: within so long after the alarm the chassis is so far from where it was then, in the plane,
/// and the robot has no fault. One and a half lengths of a track.
inline constexpr double kEscapeTime_s = 30.0;
inline constexpr double kEscapeDistance_m = 0.25;

/// One motion of a manoeuvre.
struct ManoeuvreStep {
  double duration_s;
  double speed_m_per_s;
  double turn_deg_per_s;
};
/// Steps without end, from the first again after the last.
struct Manoeuvre {
  std::string name;
  std::vector<ManoeuvreStep> steps;
};
/// What the oracle tries, each for kManoeuvreTime_s, with the motors at the robot's control and
/// without its protection.
const std::vector<Manoeuvre>& oracle_manoeuvres();
inline constexpr double kManoeuvreTime_s = 10.0;

/// What a seed came to.
struct EscapeResult {
  StuckScenario scenario;
  bool stuck = false;  ///< the alarm came and was none of a robot that moves (kFreeShare)
  /// With its escape the robot was not stuck then: a steep pitch is a wall to it, and it backed off
  /// before the alarm (robot.cpp, feel_walls()). Its trials are not of one drive; `stuck` is false.
  bool backed_off = false;
  double alarm_s = 0.0;
  bool out_alone = false;  ///< the algorithm goes on as if nothing was
  /// It gets out alone, by the escape, or by a manoeuvre of the oracle.
  bool recoverable = false;
  /// By each manoeuvre, up to the first that gets it out; none when it gets out without one, unless
  /// all are asked for.
  std::vector<bool> out_by;
  bool out_escape = false;  ///< the firmware's escape gets it out
  double escape_s = 0.0;    ///< from the alarm until it was out
  bool held = false;        ///< it gave up: fault stuck
  std::string fault;        ///< another fault that ended the escape, or the drive before the alarm
};

struct EscapeOptions {
  bool all_manoeuvres = false;  ///< of every stuck robot
  bool oracle = true;
};

/// All trials of one seed. Physics that fails counts as not out. `progress` is called several times
/// a second, always with the share 0, and may stop the trials.
EscapeResult escape_trials(std::uint64_t seed, const EscapeOptions& options,
                           const TaskProgress& progress = {});

}  // namespace screed::nn
