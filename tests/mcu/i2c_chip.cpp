// A sensor on the simulated I2C bus.
#include "tests/mcu/i2c_chip.h"

extern "C" {
#include <simavr/avr_twi.h>
#include <simavr/sim_avr.h>
}

namespace screed::mcu {

I2cChip::I2cChip(Mcu& mcu, std::uint8_t address)
    : mcu_(mcu),
      to_mcu_(avr_io_getirq(mcu.simulator(), AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_INPUT)),
      address_(address) {
  avr_irq_register_notify(avr_io_getirq(mcu.simulator(), AVR_IOCTL_TWI_GETIRQ(0), TWI_IRQ_OUTPUT),
                          &I2cChip::on_message, this);
}

void I2cChip::set_vector(std::uint8_t first_register, int x, int y, int z) {
  std::size_t at = first_register;
  for (const int value : {x, y, z}) {
    const auto bits = static_cast<std::uint16_t>(value);
    registers[at++] = static_cast<std::uint8_t>(bits & 0xFF);
    registers[at++] = static_cast<std::uint8_t>(bits >> 8);
  }
}

void I2cChip::on_message(avr_irq_t*, std::uint32_t value, void* self) {
  static_cast<I2cChip*>(self)->handle(value);
}

void I2cChip::advance() {
  if ((pointer_ & 0x80) != 0) pointer_ = static_cast<std::uint8_t>(0x80 | ((pointer_ + 1) & 0x7F));
}

void I2cChip::handle(std::uint32_t value) {
  avr_twi_msg_irq_t message;
  message.u.v = value;
  const unsigned what = message.u.twi.msg;
  if ((what & TWI_COND_STOP) != 0) selected_ = false;
  if ((what & TWI_COND_START) != 0) {
    selected_ = present && (message.u.twi.addr >> 1) == address_;
    if ((message.u.twi.addr & 1) == 0) pointer_set_ = false;
    if (selected_ && hangs) mcu_.silence_twi();
    if (selected_) avr_raise_irq(to_mcu_, avr_twi_irq_msg(TWI_COND_ACK, message.u.twi.addr, 1));
  }
  if (!selected_) return;
  if ((what & TWI_COND_WRITE) != 0) {
    avr_raise_irq(to_mcu_, avr_twi_irq_msg(TWI_COND_ACK, message.u.twi.addr, 1));
    if (pointer_set_) {
      registers[pointer_ & 0x7F] = message.u.twi.data;
      written.push_back(pointer_ & 0x7F);
      advance();
    } else {
      pointer_ = message.u.twi.data;
      pointer_set_ = true;
    }
  }
  if ((what & TWI_COND_READ) != 0) {
    ++reads;
    avr_raise_irq(to_mcu_,
                  avr_twi_irq_msg(TWI_COND_READ, message.u.twi.addr, registers[pointer_ & 0x7F]));
    advance();
  }
}

}  // namespace screed::mcu
