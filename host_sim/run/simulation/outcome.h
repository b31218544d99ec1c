// What becomes of a run: the names of its states, what it did to its terrain, when and why it ends,
// how level the bed is on the way.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "firmware/robot/supervisor.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/physics/world/environment.h"
#include "host_sim/run/experiment/experiment.h"
#include "schema/values.h"

namespace screed {

// Names of the supervisor's states, of the leveling algorithm's states and of the faults: those of
// the schema (firmware/protocol/screed.dbc).

/// How many states there are; they are numbered from 0.
inline constexpr std::size_t kLevelingStates = message::kLevelingStateMax + 1U;

/// The name of a state; "unknown" for a number that has none.
const char* state_name(RobotState state);
const char* leveling_state_name(message::LevelingState state);
/// The names of all of them, by number.
std::vector<std::string> leveling_state_names();
/// The names of the set fault bits, or "none".
std::string fault_names(uint16_t faults);

// What a run did to its terrain: how the surface is measured, and what comes of it.

/// A terrain in figures.
struct TerrainFigures {
  TerrainStatistics heights;
  double flatness = 0.0;  ///< share of flat cells, 0..1
  RobotScaleFigures robot_scale;
};

/// The terrain before and after a run. Heights of particle beds are those of TerrainMeasure.
struct TerrainOutcome {
  TerrainFigures before;
  TerrainFigures after;
  TerrainChange change;
};

/// How the terrain of an experiment is measured, for its summary and its pictures.
class TerrainMeasure {
 public:
  /// Of a terrain without particles, flat up to 5 degrees.
  TerrainMeasure() = default;
  explicit TerrainMeasure(const Experiment& experiment);

  /// The surface that counts. On a bed of particles a Gaussian low-pass, with the radius of a
  /// particle as its standard deviation, takes away single stones: their flanks are steep whatever
  /// the bed is like. Any other terrain is taken as it is.
  HeightField surface(const HeightField& terrain) const;
  /// Whether surface() changes anything.
  bool is_filtered() const { return grain_m_ > 0.0; }
  /// Slope up to which a cell is flat.
  double flat_deg() const { return flat_deg_; }
  /// The figures of two surfaces, each from surface().
  TerrainOutcome outcome(const HeightField& before, const HeightField& after) const;
  /// The same of surfaces that have been measured already, as the first and the last point of a
  /// leveling curve.
  static TerrainOutcome outcome(const HeightField& before, const HeightField& after,
                                const LevelingPoint& first, const LevelingPoint& last);

 private:
  double grain_m_ = 0.0;  ///< 0: no particles
  double flat_deg_ = 5.0;
};

// When a run ends, and why: done, given up, off the bed, or told to stop.

/// Why a run ended. Of several reasons at once the first one counts.
enum class RunEnd : uint8_t {
  kDone,     ///< it lasted as long as the experiment says
  kFault,    ///< a fault ended the training drive: nobody clears it
  kLeftBed,  ///< the robot drove over the edge of the bed
  kStopped,  ///< it was told to stop
};

/// In words, to stand behind "ended: ".
const char* end_text(RunEnd end);

/// Frames of Algorithm 5 that a whole run of it drives; 0 under another algorithm.
uint64_t frames_to_drive(const Experiment& experiment);

/// A bed ends at its edges, unless it wraps around: a robot that drives over them has left its
/// site. Of the bed only the edges count.
bool left_bed(const HeightField& bed, const RobotView& robot);

class StopCondition {
 public:
  /// `stop` becomes true when the run is to end early; may be null, must outlive this.
  StopCondition(const Experiment& experiment, const std::atomic<bool>* stop);

  /// Counts one control tick, with the robot's states after it.
  void count_tick(RobotState state, message::LevelingState leveling);

  /// The run has lasted as long as it was to: the training drive (Algorithm 5) has driven all its
  /// frames, or idled for too long beside them; any other algorithm has had its duration.
  bool done() const;
  /// Whether no tick of the run can begin as late as this, s.
  bool is_over(double time_s) const;
  /// Nothing while the run is to go on. `off_bed`: see left_bed().
  std::optional<RunEnd> reason(bool off_bed) const;

  /// Control ticks so far.
  uint64_t ticks() const { return ticks_; }
  /// Of them those that were frames of Algorithm 5; 0 under another algorithm.
  uint64_t training_frames() const { return driven_; }
  /// Of the duration, s, at a simulated time: a training drive counts driven frames alone.
  double counted_s(double time_s) const;
  double duration_s() const { return duration_s_; }

 private:
  uint64_t ticks_to_run() const;  ///< of an algorithm that is not training drive

  uint64_t training_frames_;  ///< to be driven; 0 under another algorithm
  double duration_s_;
  const std::atomic<bool>* stop_;
  uint64_t ticks_ = 0;
  uint64_t driven_ = 0;
  bool fault_ = false;
};

// Measures the leveling of a run while it goes on: when, and of which surface. What is measured is
// in host_sim/leveling. Changes nothing in the run.

/// What comes of a run in leveling: its first and its last point.
struct LevelingOutcome {
  LevelingPoint before;
  LevelingPoint after;
};

/// Points are due at the start, at whole multiples of [metrics] interval and at the end. Terrain
/// that cannot deform is measured once, and no point of it has a transport.
class LevelingMonitor {
 public:
  /// Is given each point once, in the order of time.
  using Sink = std::function<void(const LevelingPoint&)>;
  /// The terrain as it is now. Only asked where a point is due.
  using Surface = std::function<const HeightField&()>;

  /// tread_m: distance between the robot's tracks. deformable: the terrain can change.
  LevelingMonitor(const Experiment& experiment, double tread_m, bool deformable);

  /// The point at the start, of the terrain before the run. Its edges are those of the bed.
  void begin(const HeightField& before, const Sink& sink);
  /// After each control tick, with the frame of each robot; distance_m: their paths so far. Costs
  /// are of all robots, shares of time are means over them.
  void on_tick(std::span<const SimFrame> frames, double distance_m, const Surface& terrain,
               const Sink& sink);
  /// The point at the end, of the terrain after the run. When the last tick was a point already, it
  /// is given once more, with transport.
  void end(const HeightField& after, const Sink& sink);

  /// Both points are there after end().
  const LevelingOutcome& outcome() const { return outcome_; }

 private:
  LevelingCost cost() const;
  LevelingPoint measure(const HeightField& terrain, bool with_transport);

  TerrainMeasure measure_;
  LevelingMeter meter_;
  size_t robots_;
  TraversabilityLimits limits_;
  std::vector<TraversabilityMeter> traversability_;  ///< of each robot, from begin() on
  double interval_s_;
  double transport_interval_s_;
  bool deformable_;
  double next_s_;
  double next_transport_s_;
  LevelingCost cost_;  ///< without the shares, see cost()
  LevelingOutcome outcome_;
};

}  // namespace screed
