// A run, tick by tick: who observes it, its pace, its progress, its telemetry, and the loop.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "firmware/protocol/slcan.h"
#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/ground_station/telemetry/latest_telemetry.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/simulation/outcome.h"
#include "host_sim/run/simulation/parity.h"
#include "host_sim/run/simulation/recorders.h"
#include "host_sim/run/world/frame_recorder.h"
#include "host_sim/run/world/world.h"

namespace screed {

// Observes a run: is called at every tick and changes nothing.

class SimulationObserver {
 public:
  SimulationObserver() = default;
  SimulationObserver(const SimulationObserver&) = delete;
  SimulationObserver& operator=(const SimulationObserver&) = delete;
  virtual ~SimulationObserver() = default;

  /// Before the first tick. `before`: the terrain from which the summary of the run counts changes,
  /// on soil as it was laid out. `terrain`: as the robot stands on it, settled in.
  virtual void on_begin(const HeightField& before, const HeightField& terrain) = 0;
  /// After each tick, with the frame of each robot as it was recorded and the terrain after the
  /// answers (natively that of the samples). May take its time: the run waits.
  virtual void on_tick(std::span<const SimFrame> frames, const HeightField& terrain) = 0;
  /// A new point of the leveling curve, the first one after on_begin().
  virtual void on_leveling(const LevelingPoint& /*point*/) {}
  /// After the last tick; the run is not saved yet.
  virtual void on_end() = 0;
};

// Keeps simulated time from outrunning the clock on the wall (--realtime), and tells how long a run
// has taken. Decides no result: a run is the same at every pace.

/// The clock on the wall, which tests replace.
class WallClock {
 public:
  using Time = std::chrono::steady_clock::time_point;

  WallClock() = default;
  WallClock(const WallClock&) = delete;
  WallClock& operator=(const WallClock&) = delete;
  virtual ~WallClock() = default;

  /// Never goes back.
  virtual Time now() const;
  /// Returns at once when the time has passed already.
  virtual void sleep_until(Time time);
};

class Pacer {
 public:
  /// Time begins now. Without `realtime` nothing ever waits. The clock must outlive the pacer.
  Pacer(WallClock& clock, bool realtime);

  /// Waits until so much of the clock's time has passed since the beginning, s. A run that is late
  /// goes on at full speed until it has caught up.
  void wait_until(double simulated_s);

  /// Since the beginning, s.
  double elapsed_s() const;

 private:
  WallClock& clock_;
  bool realtime_;
  WallClock::Time begin_;
};

// Tells how far a run has come while it goes on. Changes nothing in it.

/// What is told while a run goes on.
struct SimulationProgress {
  double time_s;  ///< of the duration, 0..duration_s; a training drive counts driven frames alone
  double duration_s;
  double level_deviation_before_m;  ///< of the first point of the leveling curve
  double level_deviation_m;         ///< of the last point so far
};

/// Is called ten times a simulated second and at the end of the duration.
using ProgressCallback = std::function<void(const SimulationProgress&)>;

class Progress {
 public:
  /// The callback may be empty.
  explicit Progress(ProgressCallback callback) : callback_(std::move(callback)) {}

  /// At each point of the leveling curve, the first one before the first tick.
  void on_leveling(const LevelingPoint& point);
  /// After each control tick, which ended at `time_s`.
  void on_tick(const StopCondition& stop, double time_s) const;

 private:
  ProgressCallback callback_;
  std::optional<double> before_m_;  ///< height deviation about level
  double now_m_ = 0.0;
};

// What a robot hands to its radio: counted, and the last frame of each message kept. One meter a
// robot.

class TelemetryMeter {
 public:
  /// of the radio's serial line: nominal 57,600 baud, whatever [radio] baud says
  static constexpr double kLineBytesPerS = 5760.0;

  /// One tick's answer.
  void add(uint64_t time_us, const RobotOutput& output) {
    CanFrame frame{};
    for (int i = 0; i < output.radio_out_count; ++i) {
      if (!parser_.feed(output.radio_out[i], frame)) continue;
      if (const MessageInfo* const message = find_message(frame.id))
        latest_.add_frame(time_us, frame, *message);
    }
    bytes_ += output.radio_out_count;
    frames_ += static_cast<uint64_t>(
        std::count(output.radio_out, output.radio_out + output.radio_out_count, '\r'));
  }

  /// What the robot has said, whether it arrived or not.
  const LatestTelemetry& latest() const { return latest_; }
  /// Telemetry frames: whole SLCAN lines, each ended by a carriage return.
  uint64_t frames() const { return frames_; }
  /// Share of what the radio's line carries in so many seconds, 0..1.
  double line_share(double time_s) const {
    return static_cast<double>(bytes_) / (time_s * kLineBytesPerS);
  }

 private:
  SlcanParser parser_;
  LatestTelemetry latest_;
  uint64_t frames_ = 0;
  uint64_t bytes_ = 0;
};

// Who watches what in a control tick. The world moves robots, whether firmware compiled for this
// machine or flash images, and tells of two moments in each one's tick: a sample has been read, an
// answer has been given. When all have answered the run's tick ends.

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
