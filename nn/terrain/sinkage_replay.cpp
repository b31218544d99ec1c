#include "nn/terrain/sinkage_replay.h"

#include <algorithm>

namespace screed::nn {
namespace {

constexpr std::size_t kAgain = 200;  // strides after which the surface is the recorded one again

}  // namespace

const TrackSoilModel& SinkageReplay::after(std::size_t strides, const TaskProgress& progress) {
  const TrackGeometry tracks = track_geometry(drive_.robot());
  if (!ground_.has_value()) ground_.emplace(drive_.initial_terrain(), drive_.soil(), tracks);
  while (at_ < strides) {
    const std::size_t until = std::min(strides, at_ + kAgain);
    for (; at_ < until; ++at_) {
      report_progress(progress, "replaying the drive", at_, strides);
      ground_->step_at(drive_[at_], track_plane_of(tracks, drive_[at_]));
    }
    const HeightField sinkage = ground_->sinkage();
    ground_.emplace(drive_.terrain_after(at_), sinkage, drive_.soil(), tracks);
  }
  return *ground_;
}

}  // namespace screed::nn
