// Who watches what in a control tick. The world moves robots, whether firmware compiled for this
// machine or flash images, and tells of two moments in each one's tick: a sample has been read, an
// answer has been given. When all have answered the run's tick ends.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/run/simulation/frame_recorder.h"
#include "host_sim/run/simulation/leveling_monitor.h"
#include "host_sim/run/simulation/pacer.h"
#include "host_sim/run/simulation/parity_checker.h"
#include "host_sim/run/simulation/progress.h"
#include "host_sim/run/simulation/session_recorder.h"
#include "host_sim/run/simulation/simulation_observer.h"
#include "host_sim/run/simulation/stop_condition.h"
#include "host_sim/run/simulation/telemetry_meter.h"
#include "host_sim/run/world/world.h"

namespace screed {

/// What a run keeps of one robot while it drives; everything else in the loop is the run's.
struct WatchedRobot {
  explicit WatchedRobot(const RobotSettings& settings) : parity(settings) {}

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
  /// In the order of the world. The first one's session has leveling and heights as well.
  std::span<const RecordedRobot> robots;
  LevelingMonitor& leveling;
  StopCondition& stop;
  Progress& progress;
  Pacer& pacer;
  SimulationObserver* observer;
  const HeightField& before;
};

class RunLoop : private RobotWatch {
 public:
  /// World and parts must outlive the loop.
  RunLoop(World& world, const RunParts& parts);

  /// Drives until the run is to end, and says why it did. Throws RunError when the two robots
  /// differ, the session cannot be written, the physics diverges or the image crashes.
  RunEnd run();

 private:
  std::optional<RunEnd> reason_to_end() const;
  RunEnd drive();
  bool on_sample(size_t robot, SensorSample& sample) override;
  void on_output(size_t robot, RobotOutput& output) override;
  void end_tick();
  void on_leveling(const LevelingPoint& point);

  World& world_;
  const Environment& plant_;
  std::span<const RecordedRobot> robots_;
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
