// A sensor on the I2C bus as registers.
#include "host_sim/devices/mcu/i2c_chip.h"

#include <cstdio>

namespace screed::mcu {
namespace {

constexpr std::uint8_t kAutoIncrement = 0x80;
constexpr std::uint8_t kNumber = 0x7F;

}  // namespace

I2cChip::I2cChip(TwiBus& bus, std::string name, std::uint8_t address)
    : name_(std::move(name)), address_(address) {
  bus.attach(*this);
}

void I2cChip::declare(std::uint8_t number, Access access, std::uint8_t after_power_up) {
  access_.at(number) = access;
  defaults_.at(number) = registers_.at(number) = after_power_up;
}

void I2cChip::power_up() {
  registers_ = defaults_;
  pointer_ = 0;
  pointer_set_ = false;
  was_powered();
}

bool I2cChip::select(std::uint8_t address, bool read) {
  if (!present || address != address_) return false;
  if (!read) pointer_set_ = false;
  return true;
}

void I2cChip::advance() {
  if ((pointer_ & kAutoIncrement) == 0) return;
  pointer_ = static_cast<std::uint8_t>(kAutoIncrement | ((pointer_ + 1) & kNumber));
}

void I2cChip::fail(const char* what, std::uint8_t number, std::optional<std::uint8_t> value) {
  if (failure_.has_value()) return;
  char text[64];
  if (value.has_value()) {
    std::snprintf(text, sizeof text, "0x%02X (value 0x%02X)", number, *value);
  } else {
    std::snprintf(text, sizeof text, "0x%02X", number);
  }
  failure_ = name_ + ": the program " + what + " register " + text +
             (access_.at(number) == Access::kReadOnly ? ", which is read-only"
                                                      : ", which the model does not declare");
}

bool I2cChip::write(std::uint8_t byte) {
  if (!present) return false;
  if (!pointer_set_) {
    pointer_ = byte;
    pointer_set_ = true;
    return true;
  }
  const std::uint8_t number = pointer_ & kNumber;
  if (access_.at(number) != Access::kReadWrite) fail("writes", number, byte);
  registers_.at(number) = byte;
  written.push_back(number);
  was_written(number);
  advance();
  return true;
}

std::uint8_t I2cChip::read() {
  if (!present) return 0xFF;
  const std::uint8_t number = pointer_ & kNumber;
  if (access_.at(number) == Access::kNone) fail("reads", number, std::nullopt);
  ++reads;
  const std::uint8_t value = registers_.at(number);
  was_read(number);
  advance();
  return value;
}

}  // namespace screed::mcu
