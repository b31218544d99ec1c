// The I2C bus: the ATmega32U4's TWI as master, its two wires, and the devices on them.
//
// simavr's own TWI takes a microsecond for every bit, knows no wires and cannot be held up, so its
// registers are answered here instead (data sheet 20 "2-wire Serial Interface"): bit times from
// TWBR, conditions and status codes of a master, arbitration lost against a device that holds SDA
// low, and a bus that stays busy while it does. Slave mode is not modelled.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "host_sim/devices/mcu/mcu.h"

namespace screed::mcu {

/// A device on the bus, byte by byte.
class I2cDevice {
 public:
  virtual ~I2cDevice() = default;
  /// The master calls; true: the device answers (ACK).
  virtual bool select(std::uint8_t address, bool read) = 0;
  /// A byte of the master; true: ACK.
  virtual bool write(std::uint8_t byte) = 0;
  virtual std::uint8_t read() = 0;
  virtual void stop() = 0;
};

class TwiBus {
 public:
  /// Takes the TWI's registers over. The bus has to outlive the runs of the MCU.
  explicit TwiBus(Mcu& mcu);
  TwiBus(const TwiBus&) = delete;
  TwiBus& operator=(const TwiBus&) = delete;

  /// The device has to outlive the bus.
  void attach(I2cDevice& device) { devices_.push_back(&device); }

  /// A device holds SDA low: for ever, or until it has seen that many clocks.
  void hold_data(std::optional<unsigned> until_clocks = std::nullopt);
  void release_data();
  bool data_held() const { return held_; }
  /// How often the program has driven the clock low by hand.
  unsigned clock_pulses() const { return clock_pulses_; }

 private:
  enum class Phase : std::uint8_t { kIdle, kStarted, kTransmitter, kReceiver };

  struct Hooks;
  void reset();
  void write_control(std::uint8_t value);
  void write_status(std::uint8_t value);
  void begin_start();
  void begin_byte();
  void finish();
  void finish_start();
  void finish_address();
  void finish_byte();
  void stop_devices();
  void report(std::uint8_t status);
  void after(std::uint64_t bits);
  void on_direction(std::uint8_t directions);
  std::uint64_t cycles_per_bit() const;
  std::uint8_t& control();

  Mcu& mcu_;
  void* vector_ = nullptr;  // avr_int_vector_t
  std::vector<I2cDevice*> devices_;
  I2cDevice* selected_ = nullptr;
  Phase phase_ = Phase::kIdle;
  bool busy_ = false;           // something is under way that ends with an interrupt
  bool start_waiting_ = false;  // for a free bus
  bool addressing_ = false;
  bool held_ = false;
  std::optional<unsigned> clocks_to_release_;
  bool clock_driven_ = false;
  unsigned clock_pulses_ = 0;
};

}  // namespace screed::mcu
