// USART1: the line to the radio module.
#include "hal/avr/radio_uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#include "hal/avr/ring.h"

namespace screed {
namespace avr {
namespace {

// 16 MHz / 8 / 34 = 58,824 baud: 2.1 % above 57,600, which is what the radio module makes of its
// setting as well.
constexpr uint16_t kBaudDivider = 33;

struct State {
  Ring<128> in;         // 22 ms at line rate: two ticks
  const uint8_t* next;  // byte to send
  volatile uint8_t left;
  volatile uint8_t overruns;
};
State state;

}  // namespace

ISR(USART1_RX_vect) {
  const bool lost = (UCSR1A & _BV(DOR1)) != 0;  // must be read before the byte
  const uint8_t byte = UDR1;
  const bool full = state.in.room() == 0;
  if (!full) state.in.put(byte);
  if (lost || full) state.overruns = static_cast<uint8_t>(state.overruns + 1);
}

ISR(USART1_UDRE_vect) {
  UDR1 = *state.next++;
  if (--state.left == 0) UCSR1B &= static_cast<uint8_t>(~_BV(UDRIE1));
}

void radio_uart_init() {
  UBRR1 = kBaudDivider;
  UCSR1A = _BV(U2X1);
  UCSR1C = _BV(UCSZ11) | _BV(UCSZ10);  // 8 data bits, no parity, 1 stop bit
  UCSR1B = _BV(RXCIE1) | _BV(RXEN1) | _BV(TXEN1);
}

bool radio_uart_inject(const uint8_t* bytes, uint8_t count) {
  bool fits = false;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    fits = state.in.room() >= count;
    if (fits) {
      while (count-- != 0) state.in.put(*bytes++);
    }
  }
  return fits;
}

uint8_t radio_uart_read(uint8_t* bytes, uint8_t capacity) {
  uint8_t count = 0;
  while (count < capacity && state.in.used() > 0) bytes[count++] = state.in.get();
  return count;
}

void radio_uart_write(const uint8_t* bytes, uint8_t count) {
  if (count == 0) return;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    state.next = bytes;
    state.left = count;
    UCSR1B |= _BV(UDRIE1);
  }
}

uint8_t radio_uart_overruns() {
  return state.overruns;
}

}  // namespace avr
}  // namespace screed
