// Tells how far a run has come while it goes on. Changes nothing in it.
#pragma once

#include <functional>

#include "host_sim/physics/world/environment.h"
#include "host_sim/run/simulation/stop_condition.h"
#include "host_sim/run/simulation/terrain_outcome.h"

namespace screed {

/// What is told while a run goes on.
struct SimulationProgress {
  double time_s;  ///< of the duration, 0..duration_s; a training drive counts driven frames alone
  double duration_s;
  double flatness;  ///< share of flat cells, 0..1; a few seconds old at most
};

/// Is called ten times a simulated second and at the end of the duration.
using ProgressCallback = std::function<void(const SimulationProgress&)>;

class Progress {
 public:
  /// The callback may be empty. `before`: the terrain before the run.
  Progress(ProgressCallback callback, const TerrainMeasure& measure, const HeightField& before)
      : callback_(std::move(callback)),
        measure_(measure),
        flatness_(callback_ ? measure.flatness(before) : 0.0) {}

  /// After each control tick, which ended at `time_s`.
  void on_tick(const StopCondition& stop, double time_s, const Environment& plant);

 private:
  ProgressCallback callback_;
  TerrainMeasure measure_;
  double flatness_;
};

}  // namespace screed
