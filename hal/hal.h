// The hardware abstraction layer: the only seam between the firmware and a target.
//
// Free functions, one header for every target, resolved at link time: hal/avr drives the
// ATmega32U4, hal/host forwards to the current robot of a simulated world. Only main_loop.cpp calls
// them; the core (firmware/robot) never does.
#pragma once

#include "hal/sample.h"

namespace screed {

struct BoardConstants;  // firmware/parameters/board_constants.h
struct Credentials;     // firmware/security/command_mac.h
struct Parameters;      // firmware/parameters/parameters.h

namespace hal {

/// Brings the target into its safe state (motors off) and starts its devices. Called once, first.
void init();

/// The scale factors of the board this program was built or simulated for. Constant while the
/// program runs.
const BoardConstants& board_constants();

/// The parameters this robot starts with: stored ones on the robot, those of the experiment in a
/// simulation. Read once, at the start.
const Parameters& parameters();

/// What this start authenticates commands with. Constant while the program runs.
const Credentials& credentials();

/// False when stored parameters were lost and parameters() are the defaults instead: nobody chose
/// them, so the robot must not be armed with them.
bool parameters_intact();

/// Waits for the next control tick: sleeps until the timer fires. Returns false when there is no
/// next tick, never on the robot. A simulated world asks nobody to wait: time is its own, and it
/// calls tick_firmware() (firmware/main_loop.h) when a tick is due.
bool wait_for_tick();

/// Takes the newest measurements of every device. Never blocks: a device that did not answer keeps
/// its old numbers and its FreshBit stays clear.
void read_sensors(SensorSample& sample);

/// Applies motor duty and LEDs, sends the radio bytes, begins to store a parameter. Never blocks.
/// The radio bytes must stay as they are for two ticks (a full packet takes 15.3 ms): the target
/// sends them from where they are.
void write_outputs(const RobotOutput& output);

}  // namespace hal
}  // namespace screed
