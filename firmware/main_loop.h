// The main loop, one for every target.
#pragma once

namespace screed {

class Robot;          // firmware/robot/robot.h
struct RobotOutput;   // hal/sample.h
struct SensorSample;  // hal/sample.h

/// One control tick: reads the sensors, lets the robot answer, applies its answer. Sample and
/// output are the same ones in every tick: the radio's bytes are sent from where they are.
void tick_firmware(Robot& robot, SensorSample& sample, RobotOutput& output);

/// Runs the robot until the target has no next tick: for ever on the ATmega32U4.
void main_loop();

}  // namespace screed
