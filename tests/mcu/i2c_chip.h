// A sensor on the simulated I2C bus: 128 registers, register pointer with auto-increment when its
// bit 7 is set, as LSM303D, L3GD20H and LPS25H have it. Knows nothing of what the registers mean.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tests/mcu/mcu.h"

namespace screed::mcu {

class I2cChip {
 public:
  /// address: 7 bits.
  I2cChip(Mcu& mcu, std::uint8_t address);
  I2cChip(const I2cChip&) = delete;
  I2cChip& operator=(const I2cChip&) = delete;

  std::array<std::uint8_t, 128> registers{};
  /// false: answers nothing.
  bool present = true;
  /// true: holds the bus once it is addressed: the master waits for ever, until it starts anew.
  bool hangs = false;
  std::vector<std::uint8_t> written;  ///< numbers of the registers the program wrote, in order
  unsigned reads = 0;                 ///< bytes read

  void set_vector(std::uint8_t first_register, int x, int y, int z);

 private:
  static void on_message(avr_irq_t* irq, std::uint32_t value, void* self);
  void handle(std::uint32_t value);
  void advance();

  Mcu& mcu_;
  avr_irq_t* to_mcu_;
  std::uint8_t address_;
  bool selected_ = false;
  bool pointer_set_ = false;
  std::uint8_t pointer_ = 0;
};

}  // namespace screed::mcu
