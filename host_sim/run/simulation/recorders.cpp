// What goes into a session: heights by the tiles that were written to, frames, maps.
#include "host_sim/run/simulation/recorders.h"

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

// From a tick to the rows of the session file.

namespace {

HeightMap height_map_of(const HeightField& field) {
  HeightMap map;
  map.geometry = {static_cast<uint32_t>(field.nx()),
                  static_cast<uint32_t>(field.ny()),
                  kHeightUnit_m,
                  field.spacing_m(),
                  field.node_x(0),
                  field.node_y(0),
                  field.wrap(),
                  field.edge() == BedEdge::kWalled};
  map.heights.reserve(static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny()));
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) map.heights.push_back(field.node(ix, iy));
  }
  return map;
}

}  // namespace

PathPoint path_point(const SimFrame& frame) {
  return {frame.x, frame.y, static_cast<std::size_t>(frame.leveling_state)};
}

SessionRecorder::SessionRecorder(const std::filesystem::path& file, const SessionInfo& info,
                                 const HeightField& before,
                                 const std::optional<SoilParameters>& soil)
    : writer_(file, info) {
  writer_.write_terrain_before(height_map_of(before).view());
  if (soil.has_value()) writer_.write_soil(*soil);
}

void SessionRecorder::record_heights(const HeightField& terrain) {
  watch_.emplace(terrain);
  writer_.record_heights(height_map_of(terrain).view());
}

void SessionRecorder::record_particles_before(const SphereSet& particles) {
  if (!particles.centers_m.empty()) writer_.write_particles_before(particles);
}

void SessionRecorder::record_particles_after(const SphereSet& particles) {
  if (!particles.centers_m.empty()) writer_.write_particles_after(particles);
}

void SessionRecorder::observe_terrain(const HeightField& terrain) {
  if (watch_) changes_ = watch_->changes(terrain);
}

void SessionRecorder::append(const SimFrame& frame, const SensorSample& sample,
                             const RobotOutput& output) {
  writer_.append(frame, sample, output, changes_);
  height_changes_ += changes_.size();
  if (ticks_++ % kPathTicks == 0) path_.push_back(path_point(frame));
}

void SessionRecorder::record_leveling(const LevelingPoint& point) {
  if (last_point_.has_value() && last_point_->time < point.time)
    writer_.append_leveling(*last_point_);
  last_point_ = point;
}

std::string SessionRecorder::finish(const HeightField& after) {
  if (last_point_.has_value()) writer_.append_leveling(*last_point_);
  writer_.write_terrain_after(height_map_of(after).view());
  return writer_.finish();
}

}  // namespace screed
