// The robot's board on the bench: the flashed image, its three sensor chips, encoders and a ground
// station.
#pragma once

#include <vector>

#include "hal/sample.h"
#include "host_sim/devices/mcu/board.h"
#include "tests/mcu/ground_lines.h"

namespace screed::mcu {

class Bench {
 public:
  Bench();

  /// Runs; meanwhile the chips measure a level robot at rest with a little noise, new numbers every
  /// millisecond, the tracks turn as the motors drive them, and the ground station sends its
  /// heartbeat every 100 ms.
  void run_ms(int ms);

  /// Sends a command and gives it time to act.
  void command(CommandOp op, DriveArgument argument = {0, 0});
  /// The same with a parameter of the firmware's table.
  void set_parameter(Parameters::Number number, std::int16_t value);

  /// Turns an encoder by one state change.
  void turn_left_encoder(bool forward);
  void turn_right_encoder(bool forward);

  /// What the motors get, -400..400: the compare register with the sign of the direction pin.
  int left_duty() const;
  int right_duty() const;

  /// Frames sent since the last call, those with `id` only.
  std::vector<CanFrame> frames(std::uint16_t id);
  /// The newest frame with `id` of the whole run; fails the test when there is none.
  CanFrame last_frame(std::uint16_t id) const;

  Board board;
  Mcu& mcu;
  Lsm303d& accel_mag;
  L3gd20h& gyro;
  Lps25h& baro;
  bool ground_station = false;
  bool tracks_blocked = false;
  double tracks_pushed_mm_per_s = 0;  ///< on top of what the motors do
  std::int16_t accel_z = 4096;

 private:
  void measure();
  void turn_tracks();

  GroundLines ground_;
  int ms_ = 0;
  std::int64_t left_count_ = 0;
  std::int64_t right_count_ = 0;
  double left_travel_ = 0;  // counts
  double right_travel_ = 0;
  std::size_t looked_at_ = 0;
};

/// Worst-case stack and static RAM of the image, as the budget tool has them.
unsigned computed_stack();
unsigned static_ram();

}  // namespace screed::mcu
