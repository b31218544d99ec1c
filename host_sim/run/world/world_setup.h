// What an experiment drives in: its soil and terrain, and the world made of them.
#pragma once

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/world/co_simulation.h"
#include "host_sim/run/world/world.h"

namespace screed {

/// Makes what a robot is driven in from the ground, the robot and the options of an experiment.
/// Throws InputError when they do not suit.
using EnvironmentFactory = std::function<std::unique_ptr<Environment>(
    HeightField terrain, const Assembly& model, const PlantOptions& options)>;

/// What a world is made with beside the experiment.
struct WorldSetup {
  std::string board = kDefaultBoard;  ///< a folder of boards/
  /// Programs outside at the ground end of the radio; may be null, must outlive the world.
  GroundPort* ground_port = nullptr;
  /// Of the robots behind the first, as in WorldOptions.
  std::vector<std::ostream*> further_telemetry_logs = {};
  EnvironmentFactory environment = nullptr;  ///< in place of physics; may be empty
  TaskProgress progress = nullptr;           ///< of laying and settling; may be empty, may end it
};

/// The soil an experiment asks for: the preset and what differs from it. Throws InputError.
SoilParameters make_soil(const Experiment& experiment);
/// The particles of an experiment on such a bed, computed in as many threads as the environment's
/// SCREED_THREADS says. Throws InputError when that is no number of threads.
ParticleOptions make_particles(const Experiment& experiment);
/// The terrain an experiment asks for; the surface that particles are laid up to.
HeightField make_terrain(const Experiment& experiment);
/// A world as the experiment describes it. telemetry_log may be null. Throws InputError, and what
/// setup.progress throws.
std::unique_ptr<World> make_world(const Experiment& experiment, std::ostream* telemetry_log,
                                  const WorldSetup& setup = {});
/// The same world with the image in the first robot (co_simulation.h), always of physics.
std::unique_ptr<CoSimulation> make_co_simulation(const Experiment& experiment,
                                                 std::ostream* telemetry_log,
                                                 const std::string& image,
                                                 const WorldSetup& setup = {});

}  // namespace screed
