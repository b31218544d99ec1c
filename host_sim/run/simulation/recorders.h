// What of a run goes into its session: heights, frames, maps.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/render/picture/terrain_picture.h"
#include "host_sim/run/session/session_layout.h"
#include "host_sim/run/session/session_writer.h"

namespace screed {

// Finds what changed on a height field since it looked last, at the cost of the changes and not of
// the bed.

class HeightWatch {
 public:
  explicit HeightWatch(const HeightField& field);

  /// The changes since the last call, tile by tile; valid until the next one. The field must be the
  /// one of the constructor, or one of the same size whose revisions go on.
  std::span<const HeightChange> changes(const HeightField& field);

 private:
  void look_at_tile(const HeightField& field, size_t tile);

  std::vector<Height> known_;
  std::vector<uint32_t> revisions_;
  std::vector<HeightChange> changes_;
};

// Records a run in its session file: frames, samples and answers of every tick, heights where asked
// for, and the terrain before and after. Keeps the driven path, for the pictures.

/// Ticks from one point of a recorded path to the next.
inline constexpr std::uint64_t kPathTicks = kTickRate_hz / 10;

/// Where the robot is, coloured by the leveling algorithm's state.
PathPoint path_point(const SimFrame& frame);

class SessionRecorder {
 public:
  /// Creates the file. `before`: the terrain as the experiment lays it out. `soil`: none on
  /// terrain that is no soil. Throws RunError when the file cannot be written.
  SessionRecorder(const std::filesystem::path& file, const SessionInfo& info,
                  const HeightField& before, const std::optional<SoilParameters>& soil);

  /// Records the changes of single heights as well, from this terrain on. Before the first tick, at
  /// most once.
  void record_heights(const HeightField& terrain);

  /// The particles before the first tick and after the last, each at most once; of terrain without
  /// any nothing is recorded.
  void record_particles_before(const SphereSet& particles);
  void record_particles_after(const SphereSet& particles);

  /// Whether observe_terrain() has anything to do.
  bool records_heights() const { return watch_.has_value(); }
  /// Looks for heights that have changed, when the robot has read its sensors: what is recorded of
  /// a tick is the world as its sample saw it.
  void observe_terrain(const HeightField& terrain);
  /// Records the tick. Throws RunError when the disk is full.
  void append(const SimFrame& frame, const SensorSample& sample, const RobotOutput& output);

  /// A point of the leveling curve; one of the time of the last one takes its place.
  void record_leveling(const LevelingPoint& point);

  /// Closes the file with the terrain as the run left it. Returns the content hash. Nothing may be
  /// called afterwards but the two below.
  std::string finish(const HeightField& after);

  /// Changes of single heights so far; 0 when they are not recorded.
  uint64_t height_changes() const { return height_changes_; }
  /// Every kPathTicks a point.
  const std::vector<PathPoint>& path() const { return path_; }

 private:
  SessionWriter writer_;
  std::optional<LevelingPoint> last_point_;  ///< not written yet
  std::optional<HeightWatch> watch_;
  std::span<const HeightChange> changes_;  ///< of this tick
  uint64_t height_changes_ = 0;
  uint64_t ticks_ = 0;
  std::vector<PathPoint> path_;
};

}  // namespace screed
