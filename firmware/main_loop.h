// The main loop, one for every target.
#pragma once

namespace screed {

/// Runs the robot until the target has no next tick: for ever on the ATmega32U4, to the end of the
/// run in a simulation.
void main_loop();

}  // namespace screed
