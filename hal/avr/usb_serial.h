// The serial line over USB, on the Arduino core. Nothing here waits for a host.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

/// Takes one received byte; false when there is none.
bool usb_serial_get(uint8_t& byte);

/// Sends all bytes (at most 48), or none when the host has left no room. true as well when no
/// program on the host has opened the line: then they are dropped.
bool usb_serial_put(const uint8_t* bytes, uint8_t count);

/// Starts the bootloader when the host has asked for it: the line was closed at 1200 baud.
void usb_serial_check_upload_request();

}  // namespace avr
}  // namespace screed
