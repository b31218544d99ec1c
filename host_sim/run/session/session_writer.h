// Writes a run as one HDF5 file, block by block while it runs (docs/sessions.md describes the
// file).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/run/session/session_layout.h"

namespace screed {

class SessionWriter {
 public:
  /// Rows held in memory; at most this many are lost when the program is killed.
  static constexpr std::size_t kBlockRows = 1024;

  /// Creates the file. Throws RunError when it exists already or cannot be written, InputError for
  /// a text with a NUL byte.
  SessionWriter(const std::filesystem::path& file, const SessionInfo& info);
  SessionWriter(SessionWriter&&) noexcept;
  SessionWriter& operator=(SessionWriter&&) noexcept;
  /// Without finish() the file stays as that of an unfinished run, up to the last whole block.
  ~SessionWriter();

  /// Begins to record the height map, with the map before the first tick. Before append(), once.
  void record_heights(const HeightMapView& map);

  /// Records one tick, and what it did to the recorded heights, each at most once. Throws RunError
  /// when a block cannot be written (disk full).
  void append(const SimFrame& frame, const SensorSample& sample, const RobotOutput& output,
              std::span<const HeightChange> changes = {});

  /// Adds a point of the leveling curve, a table of its own. Not part of the content hash, which
  /// has what the curve is made of.
  void append_leveling(const LevelingPoint& point);

  /// What the ground is made of, as it is used: the preset with what the experiment changed. At
  /// most once. Not part of the content hash, which has the experiment's text.
  void write_soil(const SoilParameters& soil);

  /// The terrain as the run found it and left it: each at most once, at any time before finish().
  void write_terrain_before(const HeightMapView& map);
  void write_terrain_after(const HeightMapView& map);

  /// The particles likewise. Not part of the content hash, which has the terrain that they make.
  void write_particles_before(const SphereSet& particles);
  void write_particles_after(const SphereSet& particles);

  /// Writes what is left and closes the file. Returns the content hash. Nothing may be called
  /// afterwards.
  std::string finish();

  std::uint64_t frames() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace screed
