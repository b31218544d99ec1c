// What came of a run: its summary, and the summary as JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/json.h"
#include "host_sim/devices/mcu/cycle_report.h"
#include "host_sim/run/simulation/outcome.h"

namespace screed {

/// Which run it was.
struct RunIdentity {
  std::string experiment;  ///< its name
  std::string algorithm;
  uint64_t seed = 0;
  std::string hal;  ///< native, mcu or surrogate
  std::string board;
  std::string terrain;              ///< [map] model
  std::optional<std::string> soil;  ///< the named soil; nothing on terrain that is no soil
  std::string version;              ///< of the program
};

/// What a robot did and says at the end of a run.
struct RobotSummary {
  std::string content_hash;  ///< of its session
  bool left_bed = false;     ///< it stands beyond the edge of the bed
  double distance_m = 0.0;   ///< length of the chassis' true path, in space
  double energy_j = 0.0;
  double battery_v = 0.0;
  double battery_charge = 0.0;           ///< share that is left, 0..1
  std::optional<double> charge_lasts_h;  ///< a full one, at the run's mean current
  int peaks = 0;
  bool ran = false;     ///< was in the state running at any time
  std::string state;    ///< of the supervisor at the end
  uint16_t faults = 0;  ///< latched
  /// Why the robot could not be armed at the end, in words; empty in other states than disarmed and
  /// fault, and when nothing prevented it.
  std::vector<std::string> cannot_be_armed;
  uint64_t telemetry_frames = 0;          ///< that reached the ground whole
  uint64_t telemetry_frames_sent = 0;     ///< lines the robot handed to its radio
  uint64_t telemetry_frames_damaged = 0;  ///< that reached the ground with a wrong check
  double telemetry_share = 0.0;           ///< of what the radio's line carries, 0..1
};

/// Of all robots of a run, one or more: distances, energies, peaks and telemetry frames are sums,
/// the battery is the lowest, the share of the line the highest, faults are those of any robot. The
/// content hash is over those of the robots. When states differ the state is "several".
/// What keeps robots from being armed is said of each one alone.
RobotSummary total_of(const std::vector<RobotSummary>& robots);

/// What is of a robot here is of all of them (total_of).
struct SimulationSummary : RobotSummary {
  RunIdentity identity;
  std::filesystem::path folder;
  /// Each robot, in their order, when there are several.
  std::vector<RobotSummary> robots;
  RunEnd end = RunEnd::kDone;
  /// Frames that Algorithm 5 drove; 0 under another algorithm.
  uint64_t training_frames = 0;
  /// Changes of single heights, when they were recorded.
  uint64_t height_changes = 0;
  double time_s = 0.0;
  /// of the loop alone: building the world and writing pictures do not count
  double wall_s = 0.0;
  bool ordered = true;  ///< the ground station was to arm and start the robots
  TerrainOutcome terrain;
  LevelingOutcome leveling;
  /// folders of interrupted runs that were passed over
  std::vector<std::filesystem::path> leftovers;
  std::optional<CycleReport> cycles;  ///< of a run with an image

  /// The run ended for another reason than its duration or number of frames.
  bool stopped_early() const { return end != RunEnd::kDone; }
  double real_time_factor() const { return wall_s > 0.0 ? time_s / wall_s : 0.0; }
};

/// What the robots did not do that their experiment orders, in words: one left the bed, is stopped
/// by a fault, or never ran though the ground station had 10 s to arm and start it. Nothing for a
/// run that was told to stop, or robots that only an emergency stop holds: somebody wanted that.
std::optional<std::string> shortfall_of(const SimulationSummary& summary);

/// moved_m3, cut_m3, fill_m3, deepest_cut_m, deepest_fill_m.
Json json_of(const TerrainChange& change);

/// The summary as JSON, as written to summary.json: what is part of the result, so neither wall
/// time nor folders. Same run, same bytes, in whatever folder.
std::string summary_json(const SimulationSummary& summary);

/// The same, with the run folder as well: for whoever has started the run.
Json summary_json_with_folder(const SimulationSummary& summary);

}  // namespace screed
