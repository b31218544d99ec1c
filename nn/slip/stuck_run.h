// A drive of the firmware in a simulated world, and how its slip watch did in it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/estimation/slip_watch.h"
#include "firmware/robot/robot.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/run/world/world.h"
#include "nn/slip/stuck_scenario.h"

namespace screed::nn {

/// What one tick was in truth, and to the robot.
struct SlipTick {
  std::array<std::int16_t, kSlipInputs> inputs;  ///< of the network
  bool running;
  bool evaluated;      ///< the tracks were fast enough for the network
  float speed;         ///< of the chassis, forward, m/s
  float turn;          ///< of the chassis, as speed of a track, m/s
  float faster_track;  ///< speed of the faster track, m/s, not negative
  bool backwards;      ///< the tracks drive backwards on the whole
  bool slips;          ///< the watch says so
  bool stuck;          ///< likewise
  bool stalled;        ///< the supervisor's stall faults: the tracks do not turn either
};

/// What the tick that the robot has just had was.
SlipTick slip_tick_of(const World& world, const Robot& robot);

/// Drives until its end, a fault, or the physics' failure (described in `failure`). `progress` gets
/// the share of the duration, and may stop it.
struct SlipRun {
  StuckScenario scenario;
  std::vector<SlipTick> ticks;
  std::string failure;
};
SlipRun drive(const StuckScenario& scenario, const TaskProgress& progress = {});

/// Dug in: over the next second the chassis travels less than this share of what the faster track
/// travels, and it has begun: at this moment it moves so as well.
inline constexpr double kDugInShare = 0.2;
/// An alarm is false when the chassis made more than this in the half second up to it: that it
/// would come free in the next moment cannot be known.
inline constexpr double kFreeShare = 0.4;

/// Share of the faster track's travel that the chassis made from tick `begin` to before `end`; 1
/// when the tracks stood.
double travel_share(const SlipRun& run, std::size_t begin, std::size_t end);

/// The first tick at which the robot is dug in.
std::optional<std::size_t> dug_in_at(const SlipRun& run);

struct DetectionResult {
  bool detected = false;  ///< stuck (or a stall) was detected from 1 s before to 1 s after
  double delay_s = 0.0;   ///< not negative
};
DetectionResult detection_of(const SlipRun& run, std::size_t dug_in);

struct FreeResult {
  double driven_s = 0.0;     ///< with tracks fast enough to be evaluated
  int false_alarms = 0;      ///< that began after the robot had moved
  int recovered_alarms = 0;  ///< not those, but with the half second after it it had: it came free
  int other_alarms = 0;      ///< that began while it hardly moved: slip, or dug in without a trap
};
FreeResult alarms_of(const SlipRun& run);

/// As many runs as scenarios, on as many threads; results in the scenarios' order. `progress` is
/// called from any of the threads, never from two at once, with the share of all durations.
std::vector<SlipRun> drive_all(const std::vector<StuckScenario>& scenarios, unsigned threads,
                               const TaskProgress& progress = {});

}  // namespace screed::nn
