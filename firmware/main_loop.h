// The main loop, one for every target.
#pragma once

#include "firmware/robot/robot.h"
#include "hal/hal.h"

namespace screed {

/// One control tick: reads the sensors, lets the robot answer, applies its answer. Sample and
/// output are the same ones in every tick: the radio's bytes are sent from where they are.
inline void tick_firmware(Robot& robot, SensorSample& sample, RobotOutput& output) {
  hal::read_sensors(sample);
  robot.tick(sample, output);
  hal::write_outputs(output);
}

/// Runs the robot until the target has no next tick: for ever on the ATmega32U4.
void main_loop();

}  // namespace screed
