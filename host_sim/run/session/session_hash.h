// The content hash of a session: what "same seed, same bytes" is checked with.
//
// Covers seed, experiment text, tick rate, board constants, parameters, every frame, sample and
// output, the terrains and the recorded heights; not the program version, names, or anything of the
// file that holds them.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>

#include "host_sim/core/content_hash.h"
#include "host_sim/run/session/session_info.h"

namespace screed {

class SessionHash {
 public:
  explicit SessionHash(const SessionInfo& info);

  /// Packed rows (record.h) in order; the three tables may be added in any interleaving and in
  /// blocks of any size.
  void add_frames(std::span<const std::uint8_t> rows) { frames_.add_bytes(rows); }
  void add_samples(std::span<const std::uint8_t> rows) { samples_.add_bytes(rows); }
  void add_outputs(std::span<const std::uint8_t> rows) { outputs_.add_bytes(rows); }
  void set_terrain_before(const HeightMapView& map);
  void set_terrain_after(const HeightMapView& map);
  /// Of the height series (height_series.h).
  void set_heights(std::string hash) { heights_ = std::move(hash); }

  /// The hash of all of it, 32 hexadecimal digits.
  std::string hex(std::uint64_t frames) const;

 private:
  ContentHash info_;
  ContentHash frames_;
  ContentHash samples_;
  ContentHash outputs_;
  std::string terrain_before_;
  std::string terrain_after_;
  std::string heights_;
};

}  // namespace screed
