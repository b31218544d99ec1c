// Counting ticks.
#include "host_sim/leveling/traversability.h"

#include <algorithm>
#include <cmath>
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"

namespace screed {
namespace {

constexpr double kMinTrackSpeed = 0.03;  ///< of tracks that run, m/s
constexpr double kStuckShare = 0.2;
constexpr double kWindow_s = 1.0;

double sign(double value) {
  return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0;
}

double faster_track(const SimFrame& frame) {
  return std::max(std::abs(frame.track_left), std::abs(frame.track_right));
}

}  // namespace

/// Travel counts in the sense of the tracks: they have no sign in the sum, and a robot that turns
/// round within the second is not back where it was. Magnitudes of single ticks would count the
/// shaking of a robot that digs. Summed anew each tick: a running sum would drift by rounding over
/// hours.
bool TraversabilityMeter::is_stuck(const SimFrame& frame) {
  const double along = sign(frame.track_left + frame.track_right);
  const double round = sign(frame.track_right - frame.track_left);
  second_[ticks_ % second_.size()] = {along * frame.velocity_x * kTick_s,
                                      round * frame.rate_z * limits_.half_tread_m * kTick_s,
                                      faster_track(frame) * kTick_s};
  Travel sum;
  for (const Travel& tick : second_) {
    sum.forward += tick.forward;
    sum.turn += tick.turn;
    sum.track += tick.track;
  }
  return ticks_ + 1 >= second_.size() && sum.track >= kMinTrackSpeed * kWindow_s &&
         std::abs(sum.forward) + std::abs(sum.turn) < kStuckShare * sum.track;
}

void TraversabilityMeter::on_tick(const SimFrame& frame, bool on_bed) {
  if (is_stuck(frame)) ++stuck_;
  if (portable::cos(frame.pitch) * portable::cos(frame.roll) < portable::cos(limits_.tilt_rad))
    ++tilted_;
  east_m_ += frame.delta_x;
  north_m_ += frame.delta_y;
  const bool outside =
      limits_.site_radius_m > 0.0 && portable::hypot(east_m_, north_m_) > limits_.site_radius_m;
  if (outside || !on_bed) ++off_site_;
  if (faster_track(frame) >= kMinTrackSpeed) {
    ++running_;
    slip_sum_ += 0.5 * (std::abs(frame.slip_left) + std::abs(frame.slip_right));
  }
  ++ticks_;
}

Traversability TraversabilityMeter::shares() const {
  Traversability shares;
  if (ticks_ == 0) return shares;
  const auto of_all = [this](uint64_t ticks) {
    return static_cast<double>(ticks) / static_cast<double>(ticks_);
  };
  shares.stuck = of_all(stuck_);
  shares.tilted = of_all(tilted_);
  shares.off_site = of_all(off_site_);
  if (running_ > 0) shares.slip = slip_sum_ / static_cast<double>(running_);
  return shares;
}

}  // namespace screed
