// Tells how far a run has come while it goes on. Changes nothing in it.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "host_sim/leveling/leveling_point.h"
#include "host_sim/run/simulation/stop_condition.h"

namespace screed {

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

}  // namespace screed
