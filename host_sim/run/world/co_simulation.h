// The image that is flashed, running in a world of physics, alone or beside native robots: what the
// rest of the program needs of it. Needs no simavr; a build without it (MCU=no) has this header and
// a factory that refuses.
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <utility>

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "hal/sample.h"
#include "host_sim/devices/mcu/cycle_report.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_options.h"

namespace screed {

class CoSimulation {
 public:
  virtual ~CoSimulation() = default;

  /// Runs until the program has read its sensors, and then until it has applied its answer; world
  /// and microcontroller advance in lockstep. Throws RunError when the program crashes, hangs,
  /// misuses a chip, or the physics diverges.
  virtual const SensorSample& run_to_sample() = 0;
  virtual const RobotOutput& run_to_output() = 0;

  /// The image drives the first robot, native firmware all others.
  virtual World& world() = 0;
  virtual CycleReport cycles() const = 0;

  /// Is called at the end of each control tick of the world, on the way to a sample or an output:
  /// then the native robots have read their sensors, and World::apply() takes their answers.
  /// Without it they stand still.
  void on_native_tick(std::function<void()> answer) { answer_ = std::move(answer); }

 protected:
  void let_native_robots_answer() const {
    if (answer_) answer_();
  }

 private:
  std::function<void()> answer_;
};

struct CoSimulationOptions {
  std::string elf;
  std::string board = kDefaultBoard;  ///< a folder in boards/
  Parameters parameters;              ///< stored in the EEPROM before the program starts
  Credentials credentials = credentials_of(test_key());  ///< likewise
  WorldOptions world;                                    ///< of all robots; the rest is the image's
};

/// The default image of a board: <firmware folder>/<board>/screed.elf.
std::string default_image(const std::string& board);

/// Builds world and board. telemetry_log may be null; it must outlive the result. Throws InputError
/// for a missing or foreign image, an unknown board, a build without simavr.
std::unique_ptr<CoSimulation> make_co_simulation(HeightField terrain, const Assembly& model,
                                                 const CoSimulationOptions& options,
                                                 std::ostream* telemetry_log);

}  // namespace screed
