// A recorded drive's ground with what recordings do not hold: how far tracks have pressed it.
#pragma once

#include <cstddef>
#include <optional>

#include "host_sim/core/task_progress.h"
#include "nn/terrain/drive_strides.h"
#include "nn/terrain/track_soil_model.h"

namespace screed::nn {

class SinkageReplay {
 public:
  /// The drive is referred to.
  explicit SinkageReplay(const DriveStrides& drive) : drive_(drive) {}

  /// The ground as it was recorded after so many strides, pressed by the tracks as the robot stood
  /// until then; not fewer strides than the last time. Valid until the next call.
  const TrackSoilModel& after(std::size_t strides, const TaskProgress& progress = {});

 private:
  const DriveStrides& drive_;
  std::size_t at_ = 0;
  std::optional<TrackSoilModel> ground_;
};

}  // namespace screed::nn
