// When to measure.
#include "host_sim/run/simulation/leveling_monitor.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "schema/class_values.h"

namespace screed {
namespace {

constexpr double kRounding_s = 1e-6;  ///< of times that are sums of steps

TraversabilityLimits limits_of(const Experiment& experiment, double tread_m) {
  constexpr double kRadPerCentidegree = std::numbers::pi / 18000.0;
  return {0.5 * tread_m, experiment.parameters.tilt_limit() * kRadPerCentidegree,
          experiment.parameters.site_radius() * 1e-3, BedBounds{}};
}

bool returns_to_site(const SimFrame& frame) {
  return frame.state == static_cast<int>(message::HeartbeatState::kRunning) &&
         frame.leveling_state == static_cast<int>(message::LevelingState::kReturn);
}

/// The first whole multiple of the interval behind this time; never for an interval of 0.
double next_after(double time_s, double interval_s) {
  if (interval_s <= 0.0) return std::numeric_limits<double>::infinity();
  return (std::floor((time_s + kRounding_s) / interval_s) + 1.0) * interval_s;
}

Traversability mean_shares(const std::vector<TraversabilityMeter>& robots) {
  Traversability mean;
  mean.visited = 0.0;
  for (const TraversabilityMeter& robot : robots) {
    const Traversability shares = robot.shares();
    mean.stuck += shares.stuck;
    mean.tilted += shares.tilted;
    mean.off_site += shares.off_site;
    mean.returning += shares.returning;
    mean.visited += shares.visited;
    mean.slip += shares.slip;
  }
  const auto count = static_cast<double>(robots.size());
  mean.stuck /= count;
  mean.tilted /= count;
  mean.off_site /= count;
  mean.returning /= count;
  mean.visited /= count;
  mean.slip /= count;
  return mean;
}

}  // namespace

LevelingMonitor::LevelingMonitor(const Experiment& experiment, double tread_m, bool deformable)
    : measure_(experiment),
      meter_(measure_.flat_deg()),
      robots_(experiment.robots.count),
      limits_(limits_of(experiment, tread_m)),
      interval_s_(experiment.metrics.interval_s),
      transport_interval_s_(experiment.metrics.transport_interval_s),
      deformable_(deformable),
      next_s_(next_after(0.0, interval_s_)),
      next_transport_s_(next_after(0.0, transport_interval_s_)) {}

void LevelingMonitor::begin(const HeightField& before, const Sink& sink) {
  limits_.bed = bounds_of(before);
  traversability_.assign(robots_, TraversabilityMeter(limits_));
  outcome_.before = measure(before, deformable_);
  sink(outcome_.before);
}

void LevelingMonitor::on_tick(std::span<const SimFrame> frames, double distance_m,
                              const Surface& terrain, const Sink& sink) {
  cost_.energy_j = 0.0;
  for (size_t i = 0; i < frames.size(); ++i) {
    traversability_[i].on_tick(frames[i], returns_to_site(frames[i]));
    cost_.energy_j += frames[i].energy;
  }
  const double time_s = frames.front().time;
  cost_.time_s = time_s;
  cost_.distance_m = distance_m;
  if (time_s < next_s_ - kRounding_s) return;
  next_s_ = next_after(time_s, interval_s_);
  const bool with_transport = deformable_ && time_s >= next_transport_s_ - kRounding_s;
  if (with_transport) next_transport_s_ = next_after(time_s, transport_interval_s_);
  sink(deformable_ ? measure(terrain(), with_transport)
                   : LevelingMeter::unchanged(outcome_.before, cost()));
}

void LevelingMonitor::end(const HeightField& after, const Sink& sink) {
  outcome_.after =
      deformable_ ? measure(after, true) : LevelingMeter::unchanged(outcome_.before, cost());
  sink(outcome_.after);
}

LevelingCost LevelingMonitor::cost() const {
  LevelingCost cost = cost_;
  cost.traversability = mean_shares(traversability_);
  return cost;
}

LevelingPoint LevelingMonitor::measure(const HeightField& terrain, bool with_transport) {
  if (!measure_.is_filtered()) return meter_.measure(terrain, cost(), with_transport);
  return meter_.measure(measure_.surface(terrain), cost(), with_transport);
}

}  // namespace screed
