// Comparing the tiles that were written to.
#include "host_sim/run/simulation/height_watch.h"

#include <algorithm>

namespace screed {

HeightWatch::HeightWatch(const HeightField& field) : revisions_(field.tile_revisions()) {
  known_.reserve(static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny()));
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) known_.push_back(field.node(ix, iy));
  }
}

std::span<const HeightChange> HeightWatch::changes(const HeightField& field) {
  changes_.clear();
  const std::vector<uint32_t>& revisions = field.tile_revisions();
  for (size_t tile = 0; tile < revisions.size(); ++tile) {
    if (revisions[tile] == revisions_[tile]) continue;
    revisions_[tile] = revisions[tile];
    look_at_tile(field, tile);
  }
  return changes_;
}

void HeightWatch::look_at_tile(const HeightField& field, size_t tile) {
  constexpr int kNodes = HeightField::kTileNodes;
  const int west = static_cast<int>(tile % static_cast<size_t>(field.tiles_x())) * kNodes;
  const int south = static_cast<int>(tile / static_cast<size_t>(field.tiles_x())) * kNodes;
  const int east = std::min(west + kNodes, field.nx());
  const int north = std::min(south + kNodes, field.ny());
  for (int iy = south; iy < north; ++iy) {
    for (int ix = west; ix < east; ++ix) {
      const size_t node =
          static_cast<size_t>(iy) * static_cast<size_t>(field.nx()) + static_cast<size_t>(ix);
      const Height height = field.node(ix, iy);
      if (height == known_[node]) continue;
      changes_.push_back({static_cast<uint32_t>(node), height - known_[node]});
      known_[node] = height;
    }
  }
}

}  // namespace screed
