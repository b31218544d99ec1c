// What is to be done with an experiment beside what it says itself: where to, how fast, on which
// board, who looks on.
#pragma once

#include <atomic>
#include <filesystem>
#include <optional>
#include <string>

#include "host_sim/ground_station/station/ground_station.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/run_loop.h"
#include "host_sim/run/simulation/run_report.h"
#include "host_sim/run/world/world_setup.h"

namespace screed {

struct SimulationOptions {
  std::optional<std::filesystem::path> out;  ///< the run folder; without it a numbered one
  /// Where numbered ones are made; without it in output_directory_prefix.
  std::optional<std::filesystem::path> root;
  bool realtime = false;  ///< sleep so that simulated time does not outrun the clock
  const std::atomic<bool>* stop =
      nullptr;                ///< becomes true when the run is to end early, with everything saved
  ProgressCallback progress;  ///< may be empty
  /// Of laying and settling, before the run begins; may be empty. What it throws ends
  /// run_simulation() and check_simulation() before the first file is made.
  TaskProgress setup_progress;
  /// Programs outside at the ground end of the radio; may be null. What they send is in the
  /// recorded samples, so that the run replays; running it again is another run.
  GroundPort* ground_port = nullptr;
  /// Is called at every tick; may be null.
  SimulationObserver* observer = nullptr;
  /// Record the height map tick by tick, for training data.
  bool heights = false;
  /// Write frames.csv and leveling.csv beside the session; they can be exported later as well.
  bool table = true;
  /// Draw the terrain before and after; the pictures can be exported later as well.
  bool pictures = true;
  std::string program_version;
  std::string board = kDefaultBoard;
  /// The image that is to run under the microcontroller simulation; without it the firmware runs
  /// natively.
  std::optional<std::string> image;
  std::optional<int> gdb_port;  ///< where it waits for a debugger (world_setup.h)
  /// Makes what the robot is driven in, in place of physics; may be empty.
  EnvironmentFactory environment;
  /// Side of a cell of deformable ground in that environment, m: an experiment with finer ones runs
  /// with these, and its session says so.
  double least_cell_m = 0.0;
};

// Runs an experiment: lets the firmware drive in its world (world_setup.h) tick by tick, records
// everything, leaves a run folder. The tick itself is in run_loop.cpp.

/// Throws InputError when the experiment cannot be run, as run_simulation would.
void check_simulation(const Experiment& experiment, const SimulationOptions& options);

/// Runs to the end of the duration or until told to stop. Throws InputError before anything is
/// written, RunError when the run cannot be saved; then nothing half-written stays behind.
SimulationSummary run_simulation(const Experiment& experiment, const SimulationOptions& options);

}  // namespace screed
