// The height map over a session: a key frame now and then, and between them what changed in each
// tick. Group `heights` of a session file (docs/sessions.md); for the session writer and reader.
//
// Nothing is rounded: the map of every tick comes back to the last unit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/core/content_hash.h"
#include "host_sim/core/hdf5_handle.h"
#include "host_sim/run/session/session_layout.h"

namespace screed {

class HeightSeriesWriter {
 public:
  /// Ticks from one key frame to the next: what has to be read at most to see the map of a tick.
  static constexpr std::uint64_t kKeyInterval = 4096;

  /// Makes the group in the file and takes `first`, the map before the first tick, for a key frame.
  HeightSeriesWriter(hid_t file, const HeightMapView& first);

  /// The changes of the next tick, each node at most once.
  void append(std::span<const HeightChange> changes);
  /// Writes what waits. Throw h5::Hdf5Failure when it cannot be written.
  void write();
  void close();

  /// Over all that was appended; not of how the file holds it.
  std::string hash() const { return hash_.hex(); }

 private:
  void write_key();

  h5::Handle group_;
  h5::Handle keys_;
  h5::Handle key_ticks_;
  h5::Handle nodes_;
  h5::Handle changes_;
  h5::Handle ends_;
  HeightMapGeometry geometry_;
  std::vector<std::int32_t> map_;  ///< after the last tick
  std::vector<std::uint32_t> waiting_nodes_;
  std::vector<std::int32_t> waiting_changes_;
  std::vector<std::uint64_t> waiting_ends_;
  std::uint64_t ticks_ = 0;
  std::uint64_t written_ticks_ = 0;
  std::uint64_t written_changes_ = 0;
  std::uint64_t changes_count_ = 0;
  std::uint64_t changes_at_key_ = 0;
  std::uint64_t key_count_ = 0;
  ContentHash hash_;
};

class HeightSeriesReader {
 public:
  /// Nothing when the file has no such group. Throws h5::Hdf5Failure when the group is damaged.
  static std::optional<HeightSeriesReader> open(hid_t file);

  /// Ticks whose changes are there.
  std::uint64_t ticks() const { return ends_.size(); }
  std::uint64_t changes() const { return ends_.empty() ? 0 : ends_.back(); }
  std::uint64_t key_frames() const { return key_ticks_.size(); }

  /// The map after the first `ticks` ticks; 0: before the first. Going forward in small steps is
  /// cheap, any other order costs a key frame and the changes since. Throws h5::Hdf5Failure.
  const HeightMap& after(std::uint64_t ticks);
  /// The lowest and the highest height that any tick shows.
  HeightExtremes extremes();
  /// What HeightSeriesWriter::hash() said, from the file.
  std::string hash();

 private:
  HeightSeriesReader() = default;
  void read_changes(std::uint64_t begin, std::uint64_t end);
  void read_key(std::size_t key);

  h5::Handle keys_;
  h5::Handle nodes_;
  h5::Handle changes_;
  std::vector<std::uint64_t> key_ticks_;
  std::vector<std::uint64_t> ends_;
  HeightMap map_;
  std::optional<std::uint64_t> at_;  ///< ticks that map_ shows
  std::vector<std::uint32_t> read_nodes_;
  std::vector<std::int32_t> read_changes_;
};

}  // namespace screed
