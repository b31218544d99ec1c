// Follows a recorded path beside another one, row by row, and records how far they are apart.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "nn/surrogate/recorded_drive.h"

namespace screed::nn {

/// Distances after which robots are compared, m.
inline constexpr std::array<double, 3> kRolloutDistances_m = {1.0, 5.0, 10.0};
/// Of the paths: ten poses a second.
inline constexpr std::size_t kPathFrames = 10;

struct RolloutCheck {
  bool reached = false;         ///< the recording went on so far
  bool straight = false;        ///< no turn was commanded along all of the distance
  double position_error = 0.0;  ///< share of the distance
  double heading_error_rad = 0.0;
};

struct Rollout {
  std::uint64_t start = 0;  ///< row of the session
  std::array<RolloutCheck, kRolloutDistances_m.size()> checks;
  std::vector<PlanarPose> path;  ///< ten a second, places as travelled
  /// Standard deviations of the rate of turn until the last of the distances, or the end.
  double yaw_rate_deviation_rad_per_s = 0.0;
  double recorded_yaw_rate_deviation_rad_per_s = 0.0;
};

/// Standard deviation, value by value; 0 without any.
class StandardDeviation {
 public:
  void add(double value);
  double deviation() const;

 private:
  double count_ = 0.0;
  double sum_ = 0.0;
  double squares_ = 0.0;
};

class RolloutChecker {
 public:
  /// The recording is referred to.
  RolloutChecker(const RecordedDrive& recording, std::uint64_t start);

  /// The surrogate's pose at a row; rows come one by one, from start + 1 on.
  void add_row(std::uint64_t row, const PlanarPose& pose);
  /// What has been found; nothing may be called afterwards.
  Rollout take();

 private:
  const RecordedDrive& recording_;
  Rollout rollout_;
  double heading_rad_;
  StandardDeviation yaw_rates_;
  StandardDeviation recorded_yaw_rates_;
  std::size_t next_ = 0;
  bool straight_ = true;
};

}  // namespace screed::nn
