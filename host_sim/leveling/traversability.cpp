// Counting ticks and squares.
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
constexpr double kSquare_m = 0.05;
constexpr uint64_t kVisitTicks = 10;  ///< 25 mm at full speed

/// A site of 1.4 m has 28, whatever the rounding of 0.05.
int whole_squares(double length_m) {
  return static_cast<int>(std::floor(length_m / kSquare_m + 1e-6));
}

double sign(double value) {
  return value > 0.0 ? 1.0 : value < 0.0 ? -1.0 : 0.0;
}

double faster_track(const SimFrame& frame) {
  return std::max(std::abs(frame.track_left), std::abs(frame.track_right));
}

}  // namespace

SiteCoverage::SiteCoverage(const TraversabilityLimits& limits, double start_x, double start_y)
    : reach_m_(limits.half_tread_m) {
  const double radius = limits.site_radius_m;
  double east = radius;
  double north = radius;
  west_ = -radius;
  south_ = -radius;
  if (limits.bed.edge != BedEdge::kWrapped) {
    const auto inwards = [radius](double edge) {
      return radius > 0.0 ? std::clamp(edge, -radius, radius) : edge;
    };
    west_ = inwards(-0.5 * limits.bed.width_m - start_x);
    east = inwards(0.5 * limits.bed.width_m - start_x);
    south_ = inwards(-0.5 * limits.bed.depth_m - start_y);
    north = inwards(0.5 * limits.bed.depth_m - start_y);
  }
  columns_ = whole_squares(east - west_);
  rows_ = whole_squares(north - south_);
  squares_.reserve(static_cast<size_t>(columns_) * static_cast<size_t>(rows_));
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      const double away =
          portable::hypot(west_ + (column + 0.5) * kSquare_m, south_ + (row + 0.5) * kSquare_m);
      const bool on_site = radius == 0.0 || away <= radius;
      squares_.push_back(on_site ? Square::kToVisit : Square::kElsewhere);
      if (on_site) ++of_site_;
    }
  }
}

void SiteCoverage::visit(double east, double north) {
  const auto first = [this](double at, double edge) {
    return std::max(0, static_cast<int>(std::ceil((at - reach_m_ - edge) / kSquare_m - 0.5)));
  };
  const auto last = [this](double at, double edge, int count) {
    return std::min(count - 1,
                    static_cast<int>(std::floor((at + reach_m_ - edge) / kSquare_m - 0.5)));
  };
  const int last_row = last(north, south_, rows_);
  const int last_column = last(east, west_, columns_);
  for (int row = first(north, south_); row <= last_row; ++row) {
    for (int column = first(east, west_); column <= last_column; ++column) {
      Square& square = squares_[static_cast<size_t>(row) * static_cast<size_t>(columns_) +
                                static_cast<size_t>(column)];
      if (square != Square::kToVisit) continue;
      const double dx = west_ + (column + 0.5) * kSquare_m - east;
      const double dy = south_ + (row + 0.5) * kSquare_m - north;
      if (dx * dx + dy * dy > reach_m_ * reach_m_) continue;
      square = Square::kVisited;
      ++visited_;
    }
  }
}

double SiteCoverage::share() const {
  if (of_site_ == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(visited_) / of_site_;
}

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

bool TraversabilityMeter::is_off_site(const SimFrame& frame) const {
  const BedBounds& bed = limits_.bed;
  const bool on_bed = bed.edge == BedEdge::kWrapped || (std::abs(frame.x) <= 0.5 * bed.width_m &&
                                                        std::abs(frame.y) <= 0.5 * bed.depth_m);
  return !on_bed || (limits_.site_radius_m > 0.0 &&
                     portable::hypot(east_m_, north_m_) > limits_.site_radius_m);
}

void TraversabilityMeter::on_tick(const SimFrame& frame, bool returns) {
  if (!coverage_.has_value())
    coverage_.emplace(limits_, frame.x - frame.delta_x, frame.y - frame.delta_y);
  if (is_stuck(frame)) ++stuck_;
  if (portable::cos(frame.pitch) * portable::cos(frame.roll) < portable::cos(limits_.tilt_rad))
    ++tilted_;
  east_m_ += frame.delta_x;
  north_m_ += frame.delta_y;
  if (is_off_site(frame)) ++off_site_;
  if (returns) ++returning_;
  if (ticks_ % kVisitTicks == 0) coverage_->visit(east_m_, north_m_);
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
  shares.returning = of_all(returning_);
  shares.visited = coverage_->share();
  if (running_ > 0) shares.slip = slip_sum_ / static_cast<double>(running_);
  return shares;
}

}  // namespace screed
