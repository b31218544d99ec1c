// A robot driven by a board with the flash image: after each physics step the microcontroller
// lives through the same time, with every encoder edge, sensor measurement and radio byte at its
// own moment. The motors get what the pins say.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/random.h"
#include "host_sim/devices/mcu/board.h"
#include "host_sim/run/world/world.h"

namespace screed::mcu {

class McuRobot : public RobotController {
 public:
  /// As make_image_robot().
  McuRobot(const WorldOptions& options, Environment& plant, std::size_t number);

  void begin_tick(uint64_t tick) override;
  DutyRatio duty_ratio() const override;
  /// What happens to the board in this step is known now, and has not happened yet.
  void end_step() override;
  /// Runs the board to the end of the physics step. The program marks when it has read its sensors
  /// and when it has set its outputs; the pins act on the world by themselves. Throws RunError when
  /// the program crashes, hangs or misuses a chip.
  Progress live(RobotWatch* watch) override;

  const SensorSample& sample() const override { return sample_; }
  const RobotOutput& output() const override { return output_; }
  std::optional<CycleReport> cycles() const override { return board_.cycles(); }
  Board& board() { return board_; }

  /// While true, something else sends random bytes on the robot's receive line, back to back.
  bool flood = false;

 private:
  enum class EventKind : std::uint8_t { kEdge, kAccel, kMag, kGyro, kBaro, kRadioByte };
  struct Event {
    std::uint64_t cycle;
    EventKind kind;
    Side side;
    std::int64_t value;
  };
  /// When a sensor measures next; its clock is its own.
  struct Sampler {
    double rate_hz = 0.0;
    double next_us = 0.0;
  };

  void store_in_eeprom();
  void check_parameters() const;
  void add_edges(Side side);
  void add_measurements(EventKind kind, Sampler& sampler, double rate_hz, double begin_us,
                        double end_us);
  void add_radio(std::uint64_t begin_us, std::uint64_t end_us);
  void dispatch(const Event& event);

  /// How far the microcontroller has come.
  std::uint64_t now_us() const { return board_.mcu.cycle() / kCyclesPerUs; }
  /// The board up to the next mark of the program, kNone at the end of the physics step.
  Board::Mark run_to_mark();

  std::string elf_;
  Board board_;
  bool calibration_motion_;
  WorldRandom chip_clock_;  ///< draws each chip's phase
  WorldRandom flood_bytes_;

  std::array<Sampler, 4> samplers_{};
  std::array<double, 2> position_{};  ///< of the encoders, counts
  std::array<std::uint64_t, 2> last_edge_{};
  std::vector<Event> events_;  ///< of this step, in their order
  std::size_t next_event_ = 0;
  std::uint64_t step_begin_ = 0;  ///< cycles
  std::uint64_t step_end_ = 0;
  std::optional<ImuTruth> motion_;  ///< of this step, once somebody asked
  double flood_us_ = 0.0;
  SensorSample sample_{};
  RobotOutput output_{};
  std::uint64_t last_mark_us_ = 0;
};

}  // namespace screed::mcu
