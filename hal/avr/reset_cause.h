// Why the program started: the reset flags of the MCU, and marks in RAM that outlive a reset.
//
// The bootloader runs first and clears flags. Pololu's A-Star bootloader leaves BORF to the program
// and clears PORF, EXTRF and WDRF (its source: github.com/pololu/a-star, bootloaders/caterina); the
// Arduino Caterina clears all. What it cleared is told from a mark that the program keeps in RAM
// which neither start-up code initialises: RAM survives every reset but the loss of power, and the
// bootloader's own variables lie below, its stack above.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

enum class ResetCause : uint8_t {
  kPowerOn = 0,
  kBrownOut = 1,   ///< the supply fell below the fuses' level (4.3 V) while the program ran
  kWatchdog = 2,   ///< the main loop hung
  kExternal = 3,   ///< the reset button, or a program that hung with its interrupts off
  kRequested = 4,  ///< the console asked for it
  kUpload = 5,     ///< the bootloader was asked for over USB
  kStack = 6,      ///< the stack met the variables
};

ResetCause reset_cause();

/// Says what the reset that is about to come will be.
void set_next_reset_cause(ResetCause cause);

/// Starts counting as `kExternal` again: called once the program runs.
void reset_cause_init();

}  // namespace avr
}  // namespace screed
