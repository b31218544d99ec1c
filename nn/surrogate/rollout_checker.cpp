#include "nn/surrogate/rollout_checker.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"

namespace screed::nn {
namespace {}  // namespace

void StandardDeviation::add(double value) {
  count_ += 1.0;
  sum_ += value;
  squares_ += value * value;
}

double StandardDeviation::deviation() const {
  if (count_ == 0.0) return 0.0;
  const double mean = sum_ / count_;
  return std::sqrt(std::max(0.0, squares_ / count_ - mean * mean));
}

RolloutChecker::RolloutChecker(const RecordedDrive& recording, std::uint64_t start)
    : recording_(recording), heading_rad_(recording.poses[start].heading_rad) {
  rollout_.start = start;
}

void RolloutChecker::add_row(std::uint64_t row, const PlanarPose& pose) {
  if ((row - rollout_.start) % kPathFrames == 0) rollout_.path.push_back(pose);
  if (recording_.frames[row].angular != 0.0) straight_ = false;
  yaw_rates_.add((pose.heading_rad - heading_rad_) / kTick_s);
  recorded_yaw_rates_.add(recording_.motions[row].turn_rad / kTick_s);
  heading_rad_ = pose.heading_rad;
  const double distance = recording_.distances[row] - recording_.distances[rollout_.start];
  while (next_ < kRolloutDistances_m.size() && distance >= kRolloutDistances_m.at(next_)) {
    const PlanarPose& real = recording_.poses[row];
    rollout_.checks.at(next_) = {
        true, straight_,
        portable::hypot(pose.x_m - real.x_m, pose.y_m - real.y_m) / kRolloutDistances_m.at(next_),
        std::abs(pose.heading_rad - real.heading_rad)};
    ++next_;
  }
}

Rollout RolloutChecker::take() {
  rollout_.yaw_rate_deviation_rad_per_s = yaw_rates_.deviation();
  rollout_.recorded_yaw_rate_deviation_rad_per_s = recorded_yaw_rates_.deviation();
  return std::move(rollout_);
}

}  // namespace screed::nn
