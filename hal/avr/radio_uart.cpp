// USART1: the line to the radio module.
#include "hal/avr/radio_uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <stdint.h>

#include "hal/avr/interrupts_off.h"

namespace screed {

// A ring buffer of bytes between one interrupt and the main program. Each side writes one index
// only, and an index is one byte, so neither side needs to lock the other out.

namespace avr {

template <uint8_t kSize>
class Ring {
  static_assert(kSize >= 2 && (kSize & (kSize - 1)) == 0,
                "the size must be a power of two, at most 128");

 public:
  uint8_t used() const { return static_cast<uint8_t>(put_ - got_); }
  uint8_t room() const { return static_cast<uint8_t>(kSize - used()); }
  /// Only with room() > 0.
  void put(uint8_t byte) {
    const uint8_t at = put_;
    bytes_[at & (kSize - 1)] = byte;
    put_ = static_cast<uint8_t>(at + 1);
  }
  /// Only with used() > 0.
  uint8_t get() {
    const uint8_t at = got_;
    const uint8_t byte = bytes_[at & (kSize - 1)];
    got_ = static_cast<uint8_t>(at + 1);
    return byte;
  }

 private:
  volatile uint8_t bytes_[kSize];
  volatile uint8_t put_;  // counts up for ever, modulo 256
  volatile uint8_t got_;
};

}  // namespace avr

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
  {
    const InterruptsOff interrupts_off;
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
  {
    const InterruptsOff interrupts_off;
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
