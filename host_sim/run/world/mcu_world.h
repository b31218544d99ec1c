// A board with the flash image as the first robot of a world of physics, in lockstep: for each
// physics step the plant of all robots goes ahead, and then the microcontroller lives through the
// same time.
#pragma once

#include "host_sim/devices/mcu/board.h"
#include "host_sim/run/world/co_simulation.h"
#include "host_sim/run/world/mcu_robot.h"

namespace screed::mcu {

class McuWorld : public CoSimulation {
 public:
  McuWorld(HeightField terrain, const Assembly& model, const CoSimulationOptions& options,
           std::ostream* telemetry_log);

  const SensorSample& run_to_sample() override;
  const RobotOutput& run_to_output() override;
  World& world() override { return world_; }
  CycleReport cycles() const override { return board_.cycles(); }

  Board& board() { return board_; }
  McuRobot& image_robot() { return *image_robot_; }

 private:
  void run_to(Board::Mark mark);

  Board board_;  ///< before the world: a wrong image shows before particles are laid
  McuRobot* image_robot_ = nullptr;  ///< in the world
  World world_;
};

}  // namespace screed::mcu
