// Reads session files, those of older program versions included (docs/sessions.md describes the
// file).
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "hal/sample.h"
#include "host_sim/core/sim_frame.h"
#include "host_sim/leveling/leveling_meter.h"
#include "host_sim/physics/terrain/terrain.h"
#include "host_sim/run/session/session_layout.h"

namespace screed {

class SessionReader {
 public:
  /// Opens and checks the file. Throws InputError, naming the file, when it does not exist, is
  /// truncated, is no session, was written in a newer format, or lacks what a session must have.
  explicit SessionReader(const std::filesystem::path& file);
  SessionReader(SessionReader&&) noexcept;
  SessionReader& operator=(SessionReader&&) noexcept;
  ~SessionReader();

  const SessionInfo& info() const;
  std::uint64_t frames() const;
  /// False for the file of a run that was killed: it holds the blocks written until then and no
  /// content hash.
  bool complete() const;
  /// Not complete, and was being written when it was opened: this is what was there then.
  bool running() const;
  /// As recorded; empty when the session is not complete.
  const std::string& content_hash() const;
  /// Frame columns that this program knows and the file has not: they read as NaN, or 0 for
  /// integers.
  const std::vector<std::string>& missing_columns() const;
  /// Parameters that the file does not have: info() holds their defaults.
  const std::vector<std::string>& missing_parameters() const;

  /// Fill the span with rows first, first + 1, ... Throw std::out_of_range behind the last row,
  /// InputError when the file is damaged. Blocks of some hundred rows are fastest.
  void read(std::uint64_t first, std::span<SimFrame> rows) const;
  void read(std::uint64_t first, std::span<SensorSample> rows) const;
  void read(std::uint64_t first, std::span<RobotOutput> rows) const;

  std::optional<HeightMap> terrain_before() const;
  std::optional<HeightMap> terrain_after() const;
  /// Nothing on terrain without particles, and in sessions of programs that did not record them.
  std::optional<SphereSet> particles_before() const;
  std::optional<SphereSet> particles_after() const;

  /// The leveling curve; empty where none was recorded. A figure that was not measured, or that the
  /// session's program did not know, is not a number.
  std::vector<LevelingPoint> leveling() const;

  /// Whether the height map was recorded tick by tick. The rest of this block may only be called
  /// when it was.
  bool has_heights() const;
  /// The map after so many ticks, 0..frames(); valid until the next call. Going forward is cheap.
  const HeightMap& heights_after(std::uint64_t ticks) const;
  /// The lowest and highest height of any tick; looks through the whole series.
  HeightExtremes height_extremes() const;
  /// Number of single changes in the series.
  std::uint64_t height_changes() const;

  /// The hash over what the file holds now: equal to content_hash() unless the file was edited or
  /// columns are missing.
  std::string compute_content_hash() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// Calls `use(row, frame)` for the rows up to `end`, read in blocks; returns the last frame.
template <typename Use>
SimFrame for_each_frame(const SessionReader& session, std::uint64_t end, Use use) {
  constexpr std::uint64_t kBlockRows = 1024;
  std::vector<SimFrame> frames;
  for (std::uint64_t first = 0; first < end; first += frames.size()) {
    frames.resize(std::min(kBlockRows, end - first));
    session.read(first, std::span(frames));
    for (std::size_t i = 0; i < frames.size(); ++i) use(first + i, frames[i]);
  }
  return frames.empty() ? SimFrame() : frames.back();
}

}  // namespace screed
