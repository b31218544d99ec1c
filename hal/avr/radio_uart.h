// USART1: the line to the radio module, 58,824 baud, with a ring buffer for what it receives.
#pragma once

#include <stdint.h>

namespace screed {
namespace avr {

void radio_uart_init();

/// Takes up to `capacity` received bytes; returns how many. Bytes that found the buffer full, and
/// bytes the hardware lost, are gone and counted.
uint8_t radio_uart_read(uint8_t* bytes, uint8_t capacity);

/// As if these bytes had come by radio, one behind the other. False, and none is taken, without
/// room.
bool radio_uart_inject(const uint8_t* bytes, uint8_t count);

/// Sends bytes from where they are, in the background: they must stay as they are until then, 174
/// us each. What is still being sent is cut off. Never waits.
void radio_uart_write(const uint8_t* bytes, uint8_t count);

/// Received bytes lost since start, wraps.
uint8_t radio_uart_overruns();

}  // namespace avr
}  // namespace screed
