// One board in one world of physics, in lockstep: for each physics step the motors get what the
// pins say, the bodies move, and then the microcontroller lives through the same time, with every
// encoder edge, sensor measurement and radio byte at its own moment.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "host_sim/devices/mcu/board.h"
#include "host_sim/run/world/co_simulation.h"
#include "host_sim/run/world/robot_devices.h"

namespace screed::mcu {

class McuWorld : public CoSimulation {
 public:
  McuWorld(HeightField terrain, const Assembly& model, const CoSimulationOptions& options,
           std::ostream* telemetry_log);

  const SensorSample& run_to_sample() override;
  const RobotOutput& run_to_output() override;
  const Environment& plant() const override { return plant_; }
  const GroundStation& ground_station() const override { return devices_.ground_station(); }
  CycleReport cycles() const override { return board_.cycles(); }

  GroundStation& ground_station() { return devices_.ground_station(); }
  Plant& plant() { return plant_; }
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

  void run_to(Board::Mark mark);
  void begin_step();
  void begin_tick();
  void add_edges(Side side);
  void add_measurements(EventKind kind, Sampler& sampler, double rate_hz, double begin_us,
                        double end_us);
  void add_radio(std::uint64_t begin_us, std::uint64_t end_us);
  void dispatch(const Event& event);
  std::uint64_t us_at(std::uint64_t steps) const;
  std::uint64_t now_us() const;

  CoSimulationOptions options_;
  Board board_;  ///< before the plant: a wrong image shows before particles are laid
  Plant plant_;
  RobotDevices devices_;
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
  std::uint64_t ticks_ = 0;
};

}  // namespace screed::mcu
