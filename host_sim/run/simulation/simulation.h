// Runs an experiment: lets the firmware drive in its world (world_setup.h) tick by tick, records
// everything, leaves a run folder.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "firmware/leveling/leveling.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/run/experiment/board_table.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/simulation/simulation_observer.h"
#include "host_sim/run/world/co_simulation.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_setup.h"

namespace screed {

/// What is told while a run goes on.
struct SimulationProgress {
  double time_s;
  double duration_s;
  double flatness;  ///< share of flat cells, 0..1
};

struct SimulationOptions {
  std::optional<std::filesystem::path> out;  ///< the run folder; without it a numbered one
  /// Where numbered ones are made; without it in output_directory_prefix.
  std::optional<std::filesystem::path> root;
  bool realtime = false;  ///< sleep so that simulated time does not outrun the clock
  const std::atomic<bool>* stop =
      nullptr;  ///< becomes true when the run is to end early, with everything saved
  std::function<void(const SimulationProgress&)> progress;  ///< called ten times a simulated second
  /// Programs outside at the ground end of the radio; may be null. What they send is in the
  /// recorded samples, so that the run replays; running it again is another run.
  GroundPort* ground_port = nullptr;
  /// Is called at every tick; may be null.
  SimulationObserver* observer = nullptr;
  /// Record the height map tick by tick, for training data.
  bool heights = false;
  /// Write frames.csv beside the session; it can be exported later as well.
  bool table = true;
  std::string program_version;
  std::string board = kDefaultBoard;
  /// The image that is to run under the microcontroller simulation; without it the firmware runs
  /// natively.
  std::optional<std::string> image;
  /// Makes what the robot is driven in, in place of physics; may be empty.
  EnvironmentFactory environment;
};

struct SimulationSummary {
  std::filesystem::path folder;
  std::string content_hash;
  bool stopped_early = false;
  /// Frames that Algorithm 5 drove; 0 under another algorithm.
  uint64_t training_frames = 0;
  /// Changes of single heights, when they were recorded.
  uint64_t height_changes = 0;
  bool left_bed = false;  ///< the run ended because the robot drove over the edge of the soil
  double time_s = 0.0;
  double wall_s = 0.0;  ///< of the loop alone: building the world and writing pictures do not count
  double distance_m = 0.0;  ///< length of the chassis' true path, in space
  double energy_j = 0.0;
  double outside_s = 0.0;  ///< time off the bed
  double battery_v = 0.0;
  int peaks = 0;
  std::string state;  ///< of the supervisor at the end
  uint16_t faults = 0;
  uint64_t telemetry_frames = 0;          ///< that reached the ground whole
  uint64_t telemetry_frames_sent = 0;     ///< lines the robot handed to its radio
  uint64_t telemetry_frames_damaged = 0;  ///< that reached the ground with a wrong check
  double telemetry_share = 0.0;           ///< of what the radio's line carries, 0..1
  TerrainStatistics before;
  TerrainStatistics after;
  double flatness_before = 0.0;
  double flatness_after = 0.0;
  std::vector<std::filesystem::path>
      leftovers;                      ///< folders of interrupted runs that were passed over
  std::optional<CycleReport> cycles;  ///< of a run with an image

  double real_time_factor() const { return wall_s > 0.0 ? time_s / wall_s : 0.0; }
};

/// Frames of Algorithm 5 that a whole run of it drives; 0 under another algorithm.
uint64_t frames_to_drive(const Experiment& experiment);

/// Throws InputError when the experiment cannot be run, as run_simulation would.
void check_simulation(const Experiment& experiment, const SimulationOptions& options);

/// Runs to the end of the duration or until told to stop. Throws InputError before anything is
/// written, RunError when the run cannot be saved; then nothing half-written stays behind.
SimulationSummary run_simulation(const Experiment& experiment, const SimulationOptions& options);

/// What the microcontroller's time went into, as JSON: deterministic as the run itself.
std::string cycles_json(const CycleReport& cycles);

/// The summary as JSON, as written to summary.json: all of the above but wall time and folder,
/// which are not part of the result.
std::string summary_json(const SimulationSummary& summary);

}  // namespace screed
