#include "nn/terrain/pressed_drive.h"

#include <algorithm>

namespace screed::nn {
namespace {

constexpr std::size_t kAgain = 200;  // strides after which the surface is the recorded one again

}  // namespace

const TrackGround& PressedDrive::after(std::size_t strides) {
  const TrackGeometry tracks = track_geometry(drive_.robot());
  if (!ground_.has_value()) ground_.emplace(drive_.first_ground(), drive_.soil(), tracks);
  while (at_ < strides) {
    const std::size_t until = std::min(strides, at_ + kAgain);
    for (; at_ < until; ++at_) ground_->step_at(drive_[at_], stance_of(tracks, drive_[at_]));
    const HeightField sunk = ground_->sunk();
    ground_.emplace(drive_.ground_after(at_), sunk, drive_.soil(), tracks);
  }
  return *ground_;
}

}  // namespace screed::nn
