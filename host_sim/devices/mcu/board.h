// A board on the bench: the microcontroller with its image, the sensor chips on its bus, encoders,
// motor drivers, LEDs and the battery at its pins, as the board's wiring says. Knows no world.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "firmware/parameters/parameters.h"
#include "hal/sample.h"
#include "host_sim/devices/mcu/cycle_report.h"
#include "host_sim/devices/mcu/imu_chips.h"
#include "host_sim/devices/mcu/mcu.h"
#include "host_sim/devices/mcu/twi_bus.h"
#include "host_sim/devices/mcu/wiring.h"
#include "host_sim/physics/vehicle/vehicle.h"

namespace screed::mcu {

class Board {
 public:
  /// RAM above `static_ram` bytes is painted to measure the stack.
  Board(const std::string& elf_path, const Wiring& wiring, std::uint16_t static_ram = 0);

  Mcu mcu;
  TwiBus bus;
  Lsm303d accel_mag;
  L3gd20h gyro;
  std::optional<Lps25h> baro;

  // ---- what the world does to it

  /// Puts the channels of an encoder where they are at this count; A leads B when the count rises.
  void set_encoder(Side side, std::int64_t count);
  /// A wire breaks: the pin is left to its pull-up. channel: 0 A, 1 B.
  void break_encoder_wire(Side side, int channel);
  void set_battery_v(double volt);
  void set_acceleration(const Eigen::Vector3d& mg);  ///< robot frame
  void set_magnetic_field(const Eigen::Vector3d& mgauss);
  void set_angular_rate(const Eigen::Vector3d& dps);

  // ---- what it does to the world

  /// Mean output of a driver over the battery voltage, -1..1: the PWM of Timer1 with the sign of
  /// the direction pin.
  double motor_duty_ratio(Side side) const;
  /// Lit LEDs, LedBit set.
  std::uint8_t leds() const;

  // ---- what the program shows (hal/avr/trace_markers.h); each mark interrupts the run

  enum class Mark : std::uint8_t { kNone, kStart, kSample, kOutput };
  /// The mark that interrupted the last run; cleared by the call.
  Mark take_mark();
  const SensorSample& sample() const { return sample_; }
  const RobotOutput& output() const { return output_; }
  /// The parameters the program found when it started.
  const Parameters& parameters() const { return parameters_; }

  /// Throws RunError when the program has crashed, stopped, started anew without a reset, or
  /// misused a chip.
  void check() const;
  CycleReport cycles() const;

 private:
  void on_mark(std::uint8_t value);
  void on_tick();
  void on_sleep();
  void drive_encoder(Side side);
  Eigen::Vector3d in_chip_axes(const Eigen::Vector3d& robot) const;

  Wiring wiring_;
  struct Encoder {
    std::int64_t count = 0;  ///< where it is
    bool started = false;
    std::array<bool, 2> broken{};
    std::optional<std::uint64_t> edge_at;  ///< cycle of an edge whose interrupt has not begun
    // What the program has counted, and where the encoder was in its first and last sample.
    bool counting = false;
    std::int64_t first = 0;
    std::int64_t count_at_sample = 0;
    std::uint16_t first_counted = 0;
    std::int64_t counted = 0;
  };
  std::array<Encoder, 2> encoders_;
  Mark mark_ = Mark::kNone;
  SensorSample sample_{};
  RobotOutput output_{};
  Parameters parameters_{};
  int programs_started_ = 0;

  std::optional<std::uint64_t> tick_began_;
  bool tick_answered_ = false;
  std::uint64_t ticks_ = 0;
  std::uint64_t longest_tick_ = 0;
  std::uint64_t tick_cycles_ = 0;
  std::uint64_t missed_ticks_ = 0;
  std::uint64_t worst_latency_ = 0;
  std::uint64_t edges_ = 0;
};

}  // namespace screed::mcu
