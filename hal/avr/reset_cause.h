// Why the program started: the reset flags of the MCU, and marks in RAM that outlive a reset.
//
// The bootloader runs first and clears flags. Pololu's A-Star bootloader leaves BORF to the program
// and clears PORF, EXTRF and WDRF (its source: github.com/pololu/a-star, bootloaders/caterina); the
// Arduino Caterina clears all. What it cleared is told from a mark that the program keeps in RAM
// which neither start-up code initialises: RAM survives every reset but the loss of power, and the
// bootloader's own variables lie below, its stack above.
#pragma once

#include "schema/values.h"

namespace screed {
namespace avr {

using ResetCause = message::HealthResetCause;

ResetCause reset_cause();

/// Says what the reset that is about to come will be.
void set_next_reset_cause(ResetCause cause);

/// Starts counting as `kExternal` again: called once the program runs.
void reset_cause_init();

}  // namespace avr
}  // namespace screed
