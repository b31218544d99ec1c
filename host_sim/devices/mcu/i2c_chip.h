// A sensor on the I2C bus as registers: a pointer that counts up when its bit 7 is set, as LSM303D,
// L3GD20H and LPS25H have it. Knows no physics.
//
// Only declared registers may be touched. A program that reads or writes any other has a bug that a
// real chip would hide, so it ends the simulation with one line (failure()).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/devices/mcu/twi_bus.h"

namespace screed::mcu {

enum class Access : std::uint8_t { kNone, kReadOnly, kReadWrite };

class I2cChip : public I2cDevice {
 public:
  /// address: 7 bits. Attaches itself to the bus.
  I2cChip(TwiBus& bus, std::string name, std::uint8_t address);
  I2cChip(const I2cChip&) = delete;
  I2cChip& operator=(const I2cChip&) = delete;

  const std::string& name() const { return name_; }
  /// false: answers nothing.
  bool present = true;
  /// The chip loses its supply for a moment: all registers as after power-up.
  void power_up();

  std::uint8_t register_value(std::uint8_t number) const { return registers_.at(number); }
  /// Numbers of the registers the program wrote, in order.
  std::vector<std::uint8_t> written;
  unsigned reads = 0;  ///< bytes read
  /// What the program did wrong, if it did.
  const std::optional<std::string>& failure() const { return failure_; }

  bool select(std::uint8_t address, bool read) override;
  bool write(std::uint8_t byte) override;
  std::uint8_t read() override;
  void stop() override {}

 protected:
  void declare(std::uint8_t number, Access access, std::uint8_t after_power_up = 0);
  std::uint8_t& at(std::uint8_t number) { return registers_.at(number); }
  /// The register has been read or written by the program.
  virtual void was_read(std::uint8_t number) = 0;
  virtual void was_written(std::uint8_t number) = 0;
  virtual void was_powered() = 0;

 private:
  static constexpr std::size_t kRegisters = 128;
  void advance();
  void fail(const char* what, std::uint8_t number, std::optional<std::uint8_t> value);

  std::string name_;
  std::uint8_t address_;
  std::array<Access, kRegisters> access_{};
  std::array<std::uint8_t, kRegisters> registers_{};
  std::array<std::uint8_t, kRegisters> defaults_{};
  bool pointer_set_ = false;
  std::uint8_t pointer_ = 0;
  std::optional<std::string> failure_;
};

}  // namespace screed::mcu
