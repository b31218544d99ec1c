// The image that is flashed, running in a world of physics: what the rest of the program needs of
// it. Needs no simavr; a build without it (MCU=no) has this header and a factory that refuses.
#pragma once

#include <memory>
#include <optional>
#include <ostream>
#include <string>

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "hal/sample.h"
#include "host_sim/devices/mcu/cycle_report.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/run/experiment/board_table.h"
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

  virtual const Environment& plant() const = 0;
  virtual const GroundStation& ground_station() const = 0;
  virtual CycleReport cycles() const = 0;
};

struct CoSimulationOptions {
  std::string elf;
  std::string board = kDefaultBoard;  ///< a folder in boards/
  Parameters parameters;              ///< stored in the EEPROM before the program starts
  Credentials credentials = credentials_of(test_key());  ///< likewise
  WorldOptions world;
};

/// The default image of a board: <firmware folder>/<board>/screed.elf.
std::string default_image(const std::string& board);

/// Builds world and board. telemetry_log may be null; it must outlive the result. Throws InputError
/// for a missing or foreign image, an unknown board, a build without simavr.
std::unique_ptr<CoSimulation> make_co_simulation(HeightField terrain, const Assembly& model,
                                                 const CoSimulationOptions& options,
                                                 std::ostream* telemetry_log);

}  // namespace screed
