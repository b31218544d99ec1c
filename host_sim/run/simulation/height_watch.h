// Finds what changed on a height field since it looked last, at the cost of the changes and not of
// the bed.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/session/session_info.h"

namespace screed {

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

}  // namespace screed
