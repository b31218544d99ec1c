// Observes a run: is called at every tick and changes nothing.
#pragma once

#include <span>

#include "host_sim/core/sim_frame.h"
#include "host_sim/leveling/leveling_point.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

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

}  // namespace screed
