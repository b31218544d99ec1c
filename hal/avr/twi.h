// I2C master driven by its interrupt, 400 kHz: one register transfer at a time, no waiting. Knows
// no devices.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

struct TwiTransfer {
  uint8_t address;  ///< 7 bits
  uint8_t reg;      ///< first register; the devices' auto-increment bit is the caller's
  uint8_t size;     ///< bytes, at least 1
  uint8_t tag;      ///< the user's
  bool write;
  uint8_t* data;  ///< must stay until the transfer has ended
};

/// What twi_start() and twi_done() begin. The driver counts `size` and `data` on as bytes travel.
extern TwiTransfer twi_transfer;

void twi_init();

/// Starts twi_transfer. Only while none is running. Interrupts must be off.
void twi_start();

/// Frees a bus that a device holds: drops the running transfer without twi_done(), clocks the bus
/// up to nine times until the device lets go, makes a stop condition. Takes 120 us at most.
void twi_recover();

/// Called from the interrupt when a transfer has ended; `ok` when every byte was acknowledged.
/// Defined by the user of the bus: fills in twi_transfer and returns true to go on with another
/// one at once.
bool twi_done(bool ok);

}  // namespace avr
}  // namespace screed
