// The serial line over USB, on the Arduino core.
//
// The core waits without bound, interrupts off, for data of a control transfer that a host has
// announced: one that breaks off there ends in a reset by the watchdog. The image's own driver
// (hal/avr/usb) does not.
#include "hal/avr/usb_serial.h"

#include <Arduino.h>
#include <util/atomic.h>

#include "hal/avr/reset_cause.h"
#include "hal/avr/watchdog.h"

namespace screed {
namespace avr {
namespace {

constexpr uint32_t kTouchBaud = 1200;

}  // namespace

bool usb_serial_get(uint8_t& byte) {
  const int received = Serial.Serial_::read();
  if (received < 0) return false;
  byte = static_cast<uint8_t>(received);
  return true;
}

bool usb_serial_put(const uint8_t* bytes, uint8_t count) {
  // A closed line would be full after one buffer, for ever.
  if (!Serial.dtr()) return true;
  bool sent = false;
  // The core waits when a buffer fills up, and its interrupt of each USB frame takes room away: so
  // that one is held off, and a buffer is never filled to the last byte.
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    if (Serial.Serial_::availableForWrite() > count) {
      Serial.Serial_::write(bytes, count);
      sent = true;
    }
  }
  return sent;
}

void usb_serial_init() {}  // the core's main() has attached it

void usb_serial_step() {
  if (Serial.baud() != kTouchBaud || Serial.dtr()) return;
  // The core has written the bootloader's key, set the watchdog, and waits for the reset; but this
  // program feeds the watchdog. The key lies at 0x0800, between variables and stack: the build
  // checks that both keep off (firmware.mk).
  set_next_reset_cause(ResetCause::kUpload);
  watchdog_reset_now();
}

}  // namespace avr
}  // namespace screed
