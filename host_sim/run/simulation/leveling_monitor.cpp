// When to measure.
#include "host_sim/run/simulation/leveling_monitor.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace screed {
namespace {

constexpr double kRounding_s = 1e-6;  ///< of times that are sums of steps

TraversabilityLimits limits_of(const Experiment& experiment, double tread_m) {
  constexpr double kRadPerCentidegree = std::numbers::pi / 18000.0;
  return {0.5 * tread_m, experiment.parameters.tilt_limit * kRadPerCentidegree,
          experiment.parameters.site_radius * 1e-3};
}

/// The first whole multiple of the interval behind this time; never for an interval of 0.
double next_after(double time_s, double interval_s) {
  if (interval_s <= 0.0) return std::numeric_limits<double>::infinity();
  return (std::floor((time_s + kRounding_s) / interval_s) + 1.0) * interval_s;
}

bool on_bed(const SimFrame& frame, const HeightField& terrain) {
  return terrain.wrap() || terrain.inside(frame.x, frame.y);
}

}  // namespace

LevelingMonitor::LevelingMonitor(const Experiment& experiment, double tread_m, bool deformable)
    : measure_(experiment),
      meter_(measure_.flat_deg()),
      traversability_(limits_of(experiment, tread_m)),
      interval_s_(experiment.metrics.interval_s),
      transport_interval_s_(experiment.metrics.transport_interval_s),
      deformable_(deformable),
      next_s_(next_after(0.0, interval_s_)),
      next_transport_s_(next_after(0.0, transport_interval_s_)) {}

void LevelingMonitor::begin(const HeightField& before, const Sink& sink) {
  outcome_.before = measure(before, deformable_);
  sink(outcome_.before);
}

void LevelingMonitor::on_tick(const SimFrame& frame, double distance_m, const HeightField& terrain,
                              const Sink& sink) {
  traversability_.on_tick(frame, on_bed(frame, terrain));
  cost_.time_s = frame.time;
  cost_.distance_m = distance_m;
  cost_.energy_j = frame.energy;
  if (frame.time < next_s_ - kRounding_s) return;
  next_s_ = next_after(frame.time, interval_s_);
  const bool with_transport = deformable_ && frame.time >= next_transport_s_ - kRounding_s;
  if (with_transport) next_transport_s_ = next_after(frame.time, transport_interval_s_);
  sink(measure(terrain, with_transport));
}

void LevelingMonitor::end(const HeightField& after, const Sink& sink) {
  outcome_.after = measure(after, deformable_);
  sink(outcome_.after);
}

LevelingPoint LevelingMonitor::measure(const HeightField& terrain, bool with_transport) {
  LevelingCost cost = cost_;
  cost.traversability = traversability_.shares();
  if (!measure_.is_filtered()) return meter_.measure(terrain, cost, with_transport);
  return meter_.measure(measure_.surface(terrain), cost, with_transport);
}

}  // namespace screed
