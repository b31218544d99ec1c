// The three chips of the AltIMU-10 v4 as their registers show them: identity, configuration, output
// rate, full scale, data-ready and overrun bits, block data update.
//
// Source: ST's data sheets of LSM303D, L3GD20H and LPS25H, "Register description". Not modelled,
// and not declared, are interrupts, FIFO, high-pass filters, offsets and the temperature of
// LSM303D. Anti-alias and low-pass filters are accepted and have no effect: what the sensors feel
// has been averaged already (host_sim/physics/world/plant.h).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "host_sim/devices/mcu/i2c_chip.h"

namespace screed::mcu {

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
