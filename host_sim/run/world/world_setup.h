// What an experiment drives in: its soil and terrain, and the world made of them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/physics/vehicle/vehicle_options.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/prepared_world.h"
#include "host_sim/run/world/world.h"

namespace screed {

/// Makes what a robot is driven in from the ground, the robot and the options of an experiment.
/// Throws InputError when they do not suit.
using EnvironmentFactory = std::function<std::unique_ptr<Environment>(
    HeightField terrain, const Assembly& model, const PlantOptions& options)>;

/// What a world is made with beside the experiment.
struct WorldSetup {
  std::string board = kDefaultBoard;  ///< a folder of boards/
  /// The flash image that drives the first robot; firmware compiled for this machine all others.
  std::optional<std::string> image = std::nullopt;
  /// The port of this machine at which the image waits for a debugger, before its first
  /// instruction.
  std::optional<int> gdb_port = std::nullopt;
  /// Programs outside at the ground end of the first robot's radio; may be null, must outlive the
  /// world.
  GroundPort* ground_port = nullptr;
  /// One a robot, or none; each may be null, must outlive the world.
  std::vector<std::ostream*> telemetry_logs = {};
  EnvironmentFactory environment = nullptr;  ///< in place of physics; may be empty
  TaskProgress progress = nullptr;           ///< of laying and settling; may be empty, may end it
};

/// That of the stand-in.
EnvironmentFactory stand_in_environment();
/// The soil an experiment asks for: the preset and what differs from it. Throws InputError.
SoilParameters make_soil(const Experiment& experiment);
/// The particles of an experiment on such a bed, computed in as many threads as the environment's
/// SCREED_THREADS says. Throws InputError when that is no number of threads.
ParticleOptions make_particles(const Experiment& experiment);
/// The terrain an experiment asks for; the surface that particles are laid up to.
HeightField make_terrain(const Experiment& experiment);
/// What a bed of very many cells or particles costs, as a sentence for the user before it is built;
/// nothing of any other bed. `least_cell_m`: cells are no smaller.
std::optional<std::string> large_bed_note(const Experiment& experiment, double least_cell_m = 0.0);
/// How the robot is driven. Throws InputError for a board of unknown name.
VehicleOptions vehicle_options(const Experiment& experiment, const std::string& board);
/// What is each robot's own in an experiment, on a board of this name. Throws InputError for an
/// unknown one.
std::vector<RobotOptions> robot_options(const Experiment& experiment, const std::string& board);
/// What the experiment comes to in the stand-in, on cells as coarse as there; nobody listens to its
/// robots yet. Throws InputError.
PreparedWorld prepare_standin(const Experiment& experiment,
                              const std::string& board = kDefaultBoard);
/// A world as the experiment describes it. Throws InputError, and what setup.progress throws.
std::unique_ptr<World> make_world(const Experiment& experiment, const WorldSetup& setup = {});

}  // namespace screed
