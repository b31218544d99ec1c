// Who calls whom in a control tick: world, firmware, and everything that watches them.
//
// The firmware is either the main loop compiled for this machine (firmware/main_loop.cpp), which
// asks its HAL for the next tick and so advances the world, or the flash image, which lives in a
// co-simulation that is asked to run on. Of several robots the first one sets the pace, as image or
// main loop; the others are cores (further_robots.h). The watchers see the same two moments in all:
// a sample has been read, an answer has been given.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/run/simulation/frame_recorder.h"
#include "host_sim/run/simulation/further_robots.h"
#include "host_sim/run/simulation/leveling_monitor.h"
#include "host_sim/run/simulation/pacer.h"
#include "host_sim/run/simulation/parity_checker.h"
#include "host_sim/run/simulation/progress.h"
#include "host_sim/run/simulation/run_world.h"
#include "host_sim/run/simulation/session_recorder.h"
#include "host_sim/run/simulation/simulation_observer.h"
#include "host_sim/run/simulation/stop_condition.h"
#include "host_sim/run/simulation/telemetry_meter.h"

namespace screed {

/// What a run keeps of one robot while it drives; everything else in the loop is the run's.
struct WatchedRobot {
  explicit WatchedRobot(const RobotSettings& settings)
      : parity(settings.board, settings.parameters, settings.credentials) {}

  ParityChecker parity;
  FrameRecorder frames;
  TelemetryMeter telemetry;
  SensorSample sample{};  ///< of this tick
  /// World at the sample, robot after the shadow's answer: made in on_sample(), written in
  /// on_output().
  SimFrame frame;
  bool ran = false;  ///< was in the state running, at any time
};

/// A robot and the session that it is recorded in.
struct RecordedRobot {
  WatchedRobot& robot;
  SessionRecorder& recorder;
};

/// What takes part in every tick. The observer may be null; `before` is what it is shown as the
/// terrain before the run.
struct RunParts {
  WatchedRobot& robot;
  SessionRecorder& recorder;  ///< of that robot; of leveling and heights as well
  LevelingMonitor& leveling;
  StopCondition& stop;
  Progress& progress;
  Pacer& pacer;
  SimulationObserver* observer;
  const HeightField& before;
  /// Behind the first one, in the order of the world.
  std::vector<RecordedRobot> further_robots = {};
};

class RunLoop {
 public:
  /// World and parts must outlive the loop.
  RunLoop(RunWorld& world, const RunParts& parts);

  /// Drives until the run is to end, and says why it did. Throws RunError when the two robots
  /// differ, the session cannot be written, the physics diverges or the image crashes.
  RunEnd run();

 private:
  class NativeTarget;

  RunEnd run_native(FurtherRobots& further);
  RunEnd run_image(CoSimulation& image, FurtherRobots& further);

  std::optional<RunEnd> reason_to_end() const;
  void on_sample(size_t robot, const SensorSample& sample);
  void on_output(size_t robot, const RobotOutput& output);
  /// When the first robot has answered, and the others as far as their time has come.
  void end_tick();
  void on_leveling(const LevelingPoint& point);

  RunWorld& world_;
  const Environment& plant_;
  std::vector<RecordedRobot> robots_;
  std::vector<SimFrame> frames_;  ///< of the robots in this tick
  LevelingMonitor& leveling_;
  const LevelingMonitor::Sink take_point_ = [this](const LevelingPoint& point) {
    on_leveling(point);
  };
  StopCondition& stop_;
  Progress& progress_;
  Pacer& pacer_;
  SimulationObserver* observer_;
  const HeightField& before_;
};

}  // namespace screed
