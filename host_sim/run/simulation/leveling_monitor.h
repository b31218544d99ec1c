// Measures the leveling of a run while it goes on: when, and of which surface. What is measured is
// in host_sim/leveling. Changes nothing in the run.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/terrain_outcome.h"

namespace screed {

/// What comes of a run in leveling: its first and its last point.
struct LevelingOutcome {
  LevelingPoint before;
  LevelingPoint after;
};

/// Points are due at the start, at whole multiples of [metrics] interval and at the end. Terrain
/// that cannot deform is measured once, and no point of it has a transport.
class LevelingMonitor {
 public:
  /// Is given each point once, in the order of time.
  using Sink = std::function<void(const LevelingPoint&)>;
  /// The terrain as it is now. Only asked where a point is due.
  using Surface = std::function<const HeightField&()>;

  /// tread_m: distance between the robot's tracks. deformable: the terrain can change.
  LevelingMonitor(const Experiment& experiment, double tread_m, bool deformable);

  /// The point at the start, of the terrain before the run. Its edges are those of the bed.
  void begin(const HeightField& before, const Sink& sink);
  /// After each control tick, with the frame of each robot; distance_m: their paths so far. Costs
  /// are of all robots, shares of time are means over them.
  void on_tick(std::span<const SimFrame> frames, double distance_m, const Surface& terrain,
               const Sink& sink);
  /// The point at the end, of the terrain after the run. When the last tick was a point already, it
  /// is given once more, with transport.
  void end(const HeightField& after, const Sink& sink);

  /// Both points are there after end().
  const LevelingOutcome& outcome() const { return outcome_; }

 private:
  LevelingCost cost() const;
  LevelingPoint measure(const HeightField& terrain, bool with_transport);

  TerrainMeasure measure_;
  LevelingMeter meter_;
  size_t robots_;
  TraversabilityLimits limits_;
  std::vector<TraversabilityMeter> traversability_;  ///< of each robot, from begin() on
  double interval_s_;
  double transport_interval_s_;
  bool deformable_;
  double next_s_;
  double next_transport_s_;
  LevelingCost cost_;  ///< without the shares, see cost()
  LevelingOutcome outcome_;
};

}  // namespace screed
