// Somebody who looks on while a run goes on: sees every tick and changes none.
#pragma once

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/session/frame.h"

namespace screed {

class SimulationOnlooker {
 public:
  SimulationOnlooker() = default;
  SimulationOnlooker(const SimulationOnlooker&) = delete;
  SimulationOnlooker& operator=(const SimulationOnlooker&) = delete;
  virtual ~SimulationOnlooker() = default;

  /// Before the first tick, with the ground as the robot stands on it.
  virtual void begin(const HeightField& ground) = 0;
  /// After each tick, with the frame as it was recorded and the ground of that moment. May take its
  /// time: the run waits.
  virtual void see(const Frame& frame, const HeightField& ground) = 0;
  /// After the last tick; the run is not saved yet.
  virtual void end() = 0;
};

}  // namespace screed
