// Two recorded runs side by side: whether they are the same, where they begin to differ, and how
// far they are apart.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/physics/terrain/height_map.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/run/session/session_reader.h"

namespace screed {

/// A key of the configuration whose values differ; nothing where a run does not have it.
struct KeyDifference {
  std::string key;  ///< section.key of the experiment, or "board"
  std::optional<std::string> a;
  std::optional<std::string> b;
};

/// Where two recordings part.
struct FirstDifference {
  std::uint64_t tick = 0;
  double time_s = 0.0;
  std::string
      column;  ///< "samples.gyro[0]": what a tick reads, answers and leads to, in this order
  std::string a;
  std::string b;
  std::vector<std::string> all_columns;  ///< everything that differs in this tick
};

/// A moment of a run, ten a second, the last frame too.
struct TracePoint {
  double time_s;
  double x_m;  ///< on the bed
  double y_m;
  double battery_v;
  int leveling_state;
  int beds_x;  ///< times that it went over the eastern edge of a wrapped bed, less the western
  int beds_y;
};

/// How a run ended.
struct FinalState {
  double time_s = 0.0;
  double x_m = 0.0;  ///< as travelled: with wrap-around it may lie beyond the bed
  double y_m = 0.0;
  double heading_rad = 0.0;
  double distance_m = 0.0;  ///< driven
  std::string state;
  std::string leveling_state;
  std::string faults;  ///< "none" without
  double battery_v = 0.0;
  double energy_j = 0.0;
  /// Since the start, as in the run's summary; nothing when the run did not record both terrains.
  std::optional<TerrainChange> change;
};

struct ComparedRun {
  std::string name;  ///< of the experiment
  std::string program_version;
  std::uint64_t seed = 0;
  std::uint64_t frames = 0;
  bool complete = false;
  std::string content_hash;
  std::vector<TracePoint> trace;
  FinalState end;                    ///< of no use without a frame
  std::optional<HeightMap> before;   ///< the terrain as it was laid out
  std::optional<HeightMap> terrain;  ///< as the run left it
};

/// Position and heading of B seen from A at the same time.
struct DeviationPoint {
  double time_s;
  double position_m;   ///< >= 0, in the plane
  double heading_rad;  ///< -pi..pi, positive: B has turned further counter-clockwise
};

struct DeviationSummary {
  DeviationPoint last;  ///< at the last tick that both have
  DeviationPoint largest_position;
  DeviationPoint largest_heading;
};

/// Height of B above A at the end of the runs; particles without single stones (TerrainMeasure).
struct TerrainDifference {
  std::string not_comparable;  ///< why; empty: the rest holds
  TerrainChange change;        ///< from A to B: fill is what B has above A
  double rms_m = 0.0;
  /// All nodes, as in HeightMap; empty when not comparable.
  std::vector<double> height_m;
};

struct SessionComparison {
  std::array<ComparedRun, 2> runs;
  std::vector<KeyDifference> configuration;
  std::uint64_t common_ticks = 0;
  std::optional<FirstDifference> first;     ///< nothing: equal in all common ticks
  std::vector<DeviationPoint> deviation;    ///< ten a second
  std::optional<DeviationSummary> summary;  ///< nothing without a common tick
  TerrainDifference terrain;
  /// The terrains before agree, height by height.
  bool same_start = false;
  /// And those after.
  bool same_terrain = false;

  /// Same configuration, ticks and terrain. The program's version may differ.
  bool identical() const;
};

/// The keys in which two experiment texts differ, in the order of the first. A command key is not
/// shown. Throws InputError for a text that is no experiment.
std::vector<KeyDifference> configuration_difference(const std::string& a, const std::string& b);

/// Throws InputError for sessions of different tick rates, and as SessionReader.
SessionComparison compare_sessions(const SessionReader& a, const SessionReader& b);

}  // namespace screed
