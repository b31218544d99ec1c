// I2C master driven by its interrupt.
#include "hal/avr/twi.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>
#include <util/delay.h>
#include <util/twi.h>

#include "hal/avr/pin.h"

namespace screed {
namespace avr {
namespace {

constexpr uint32_t kBus_hz = 400000;
// A byte and its acknowledge bit (I2C specification UM10204, 3.1.16).
constexpr uint8_t kRecoveryClocks = 9;

constexpr uint8_t kGo = _BV(TWINT) | _BV(TWEN) | _BV(TWIE);
constexpr uint8_t kIdle = _BV(TWEN);

// The pins of the TWI are the same on every ATmega32U4.
using Scl = Pin<kPortD, 0>;
using Sda = Pin<kPortD, 1>;

bool register_sent;

void finish(bool ok) {
  const bool more = twi_done(ok);
  // With both bits set the hardware makes a stop condition and then a start condition.
  TWCR = more ? static_cast<uint8_t>(kGo | _BV(TWSTO) | _BV(TWSTA))
              : static_cast<uint8_t>(kGo | _BV(TWSTO));
}

/// Acknowledges every byte but the last.
void receive_next() {
  TWCR = twi_transfer.size == 1 ? kGo : static_cast<uint8_t>(kGo | _BV(TWEA));
}

void send_next() {
  if (twi_transfer.size == 0) {
    finish(true);
    return;
  }
  --twi_transfer.size;
  TWDR = *twi_transfer.data++;
  TWCR = kGo;
}

void send(uint8_t byte) {
  TWDR = byte;
  TWCR = kGo;
}

}  // namespace

// Written by the main program only while no transfer runs, by the interrupt while one runs.
TwiTransfer twi_transfer;

ISR(TWI_vect) {
  const uint8_t status = TW_STATUS;
  if (status == TW_MR_DATA_ACK) {  // first, since two of three interrupts are
    *twi_transfer.data++ = TWDR;
    --twi_transfer.size;
    receive_next();
    return;
  }
  const uint8_t address = static_cast<uint8_t>(twi_transfer.address << 1);
  switch (status) {
    case TW_START:
      register_sent = false;
      send(address | TW_WRITE);
      break;
    case TW_MT_SLA_ACK:
    case TW_MT_DATA_ACK:  // simavr 1.6 answers with this to the address as well
      if (!register_sent) {
        register_sent = true;
        send(twi_transfer.reg);
      } else if (twi_transfer.write) {
        send_next();
      } else {
        TWCR = kGo | _BV(TWSTA);
      }
      break;
    case TW_REP_START:
      send(address | TW_READ);
      break;
    case TW_MR_SLA_ACK:
      receive_next();
      break;
    case TW_MR_DATA_NACK:
      *twi_transfer.data = TWDR;
      finish(true);
      break;
    default:  // no device, arbitration lost, bus error
      finish(false);
      break;
  }
}

void twi_init() {
  // Weak pull-ups in case the board has none.
  Scl::set();
  Sda::set();
  TWSR = 0;
  TWBR = (F_CPU / kBus_hz - 16) / 2;
  TWCR = kIdle;
}

void twi_start() {
  TWCR = kGo | _BV(TWSTA);
}

namespace {

__attribute__((noinline)) void wait_half_clock() {
  _delay_us(5);
}

}  // namespace

void twi_recover() {
  TWCR = 0;
  // Open drain by hand: low is driven, high is left to the pull-ups.
  Scl::clear();
  Sda::clear();
  for (uint8_t i = 0; i < kRecoveryClocks && !Sda::is_high(); ++i) {
    Scl::make_output();
    wait_half_clock();
    Scl::make_input();
    wait_half_clock();
  }
  // Stop condition: data rises while the clock is high.
  Scl::make_output();
  Sda::make_output();
  wait_half_clock();
  Scl::make_input();
  wait_half_clock();
  Sda::make_input();
  wait_half_clock();
  twi_init();
}

}  // namespace avr
}  // namespace screed
