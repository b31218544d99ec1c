// The serial line over USB. Nothing here waits for a host.
//
// Two implementations, of which the build takes one: hal/avr/usb, the image's own driver, and
// hal/avr/arduino, on the Arduino core's USB (the Arduino library; make firmware USB=core).
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

void usb_serial_init();

/// Answers the host, and starts the bootloader when it has asked for it (the line was closed at
/// 1200 baud). Called once a tick.
void usb_serial_step();

/// Takes one received byte; false when there is none.
bool usb_serial_get(uint8_t& byte);

constexpr uint8_t kUsbSerialPut = 63;  // Arduino's core keeps a byte of its 64 free

/// Sends all bytes (at most kUsbSerialPut), or none when the host has left no room. true as well
/// when no program on the host has opened the line: then they are dropped.
bool usb_serial_put(const uint8_t* bytes, uint8_t count);

}  // namespace avr
}  // namespace screed
