// A recorded session of Algorithm 5 as rollouts need it: all rows at once, the path as travelled,
// and the state of the robot at a row.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/run/experiment/experiment.h"
#include "host_sim/run/session/session_reader.h"
#include "nn/surrogate/surrogate_plant.h"

namespace screed::nn {

struct RecordedDrive {
  SessionReader session;
  Experiment experiment;
  SoilParameters soil;
  Battery battery;  ///< as the run began with it
  std::vector<SimFrame> frames;
  std::vector<SensorSample> samples;
  std::uint64_t first = 0;  ///< row with Algorithm 5's first frame
  std::vector<PlanarPose> poses;
  std::vector<FrameMotion> motions;
  std::vector<double> distances;  ///< travelled since the first row, m
  std::vector<double> drawn_c;    ///< from the battery since the start

  /// Throws InputError for a session that is not on soil, has no recorded heights, or in which
  /// Algorithm 5 drove nothing.
  explicit RecordedDrive(const std::filesystem::path& folder);

  /// Behind the row at which a rollout from `row` on has travelled `distance_m`; not more frames
  /// than that.
  std::uint64_t end_of_rollout(std::uint64_t row, double distance_m,
                               std::uint64_t max_frames) const;

  /// Of the robot at the end of a row. An encoder says its angle to a count: the middle of it.
  DrivingState state(std::uint64_t row, double counts_per_turn) const;
};

}  // namespace screed::nn
