// The serial line of the test images: USART1 at 2 Mbaud, polled.
#pragma once

#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <stdint.h>

namespace screed {

struct ImageLink {
  ImageLink() {
    UBRR1 = 0;
    UCSR1A = _BV(U2X1);
    UCSR1B = _BV(RXEN1) | _BV(TXEN1);
  }

  void put(uint8_t byte) {
    while ((UCSR1A & _BV(UDRE1)) == 0) {
    }
    UCSR1A = _BV(U2X1) | _BV(TXC1);
    UDR1 = byte;
  }

  uint8_t get() {
    while ((UCSR1A & _BV(RXC1)) == 0) {
    }
    return UDR1;
  }

  /// Ends the simulation once the last byte has left.
  void stop() {
    while ((UCSR1A & _BV(TXC1)) == 0) {
    }
    cli();
    sleep_enable();
    sleep_cpu();
  }
};

}  // namespace screed
