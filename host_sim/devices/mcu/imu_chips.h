// A sensor on the I2C bus as registers: a pointer that counts up when its bit 7 is set, as LSM303D,
// L3GD20H and LPS25H have it. Knows no physics.
//
// Only declared registers may be touched. A program that reads or writes any other has a bug that a
// real chip would hide, so it ends the simulation with one line (failure()).
#pragma once

#include <Eigen/Core>
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

// The three chips of the AltIMU-10 v4 as their registers show them: identity, configuration, output
// rate, full scale, data-ready and overrun bits, block data update.
//
// Source: ST's data sheets of LSM303D, L3GD20H and LPS25H, "Register description". Not modelled,
// and not declared, are interrupts, FIFO, high-pass filters, offsets and the temperature of
// LSM303D. Anti-alias and low-pass filters are accepted and have no effect: what the sensors feel
// has been averaged already (host_sim/physics/world/plant.h).

/// Output registers of a sensor with three axes behind one status register.
class VectorOutput {
 public:
  VectorOutput(std::uint8_t status, std::uint8_t first) : status_(status), first_(first) {}

  template <class Set>
  void put(const std::array<std::int16_t, 3>& counts, bool block_data_update, Set&& at);
  template <class Set>
  void was_read(std::uint8_t number, Set&& at);
  void clear() { reading_ = {}; }

 private:
  std::uint8_t status_;
  std::uint8_t first_;
  std::array<bool, 3> reading_{};  ///< the low byte has been read, the high byte not yet
};

/// Accelerometer and magnetometer.
class Lsm303d : public I2cChip {
 public:
  static constexpr std::uint8_t kAddress = 0x1D;  // SA0 high
  explicit Lsm303d(TwiBus& bus, std::uint8_t address = kAddress);

  /// Measurements a second; 0: switched off.
  double accel_rate_hz() const;
  double mag_rate_hz() const;
  /// A measurement: specific force, field, in the chip's axes.
  void measure_accel(const Eigen::Vector3d& mg);
  void measure_mag(const Eigen::Vector3d& mgauss);

 private:
  void was_read(std::uint8_t number) override;
  void was_written(std::uint8_t) override {}
  void was_powered() override;
  VectorOutput accel_;
  VectorOutput mag_;
};

/// Gyroscope.
class L3gd20h : public I2cChip {
 public:
  static constexpr std::uint8_t kAddress = 0x6B;
  explicit L3gd20h(TwiBus& bus, std::uint8_t address = kAddress);
  double rate_hz() const;
  void measure(const Eigen::Vector3d& dps);

 private:
  void was_read(std::uint8_t number) override;
  void was_written(std::uint8_t) override {}
  void was_powered() override;
  VectorOutput gyro_;
};

/// Barometer.
class Lps25h : public I2cChip {
 public:
  static constexpr std::uint8_t kAddress = 0x5D;
  explicit Lps25h(TwiBus& bus, std::uint8_t address = kAddress);
  double rate_hz() const;
  void measure(double pressure_hpa, double temperature_degc);

 private:
  void was_read(std::uint8_t number) override;
  void was_written(std::uint8_t) override {}
  void was_powered() override { reading_pressure_ = reading_temperature_ = false; }
  bool reading_pressure_ = false;
  bool reading_temperature_ = false;
};

}  // namespace screed::mcu
