// From a tick to the rows of the session file.
#include "host_sim/run/simulation/session_recorder.h"

namespace screed {
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
