// All figures of a point.
#include "host_sim/leveling/leveling_meter.h"

#include "host_sim/leveling/robot_scale.h"
#include "host_sim/leveling/transport.h"
#include "host_sim/physics/terrain/terrain_statistics.h"

namespace screed {
namespace {

void set_cost(const LevelingCost& cost, LevelingPoint& point) {
  point.time = cost.time_s;
  point.distance = cost.distance_m;
  point.energy = cost.energy_j;
  point.slip = cost.traversability.slip;
  point.stuck = cost.traversability.stuck;
  point.tilted = cost.traversability.tilted;
  point.off_site = cost.traversability.off_site;
  point.returning = cost.traversability.returning;
  point.visited = cost.traversability.visited;
}

}  // namespace

LevelingPoint LevelingMeter::measure(const HeightField& surface, const LevelingCost& cost,
                                     bool with_transport) {
  const RobotScaleFigures robot_scale = robot_scale_figures(surface, flat_deg_);
  LevelingPoint point;
  point.level_deviation = robot_scale.level_deviation_m;
  point.relief = robot_scale.relief_m;
  point.roughness = robot_scale.roughness_m;
  point.robot_scale_flatness = robot_scale.flatness;
  point.flatness = flatness(surface, flat_deg_);
  point.height_deviation = height_deviation_m(surface);
  set_cost(cost, point);
  if (with_transport) add_transport(surface, point);
  return point;
}

LevelingPoint LevelingMeter::unchanged(const LevelingPoint& earlier, const LevelingCost& cost) {
  LevelingPoint point;
  point.level_deviation = earlier.level_deviation;
  point.relief = earlier.relief;
  point.roughness = earlier.roughness;
  point.robot_scale_flatness = earlier.robot_scale_flatness;
  point.flatness = earlier.flatness;
  point.height_deviation = earlier.height_deviation;
  set_cost(cost, point);
  return point;
}

void LevelingMeter::add_transport(const HeightField& surface, LevelingPoint& point) {
  const GroundBlocks ground = ground_blocks(surface);
  point.transport = least_transport(ground);
  point.transport_error = ground.w1_error;
  point.transport_squared = least_squared_transport(ground);
  if (!start_.has_value()) start_ = point.transport;
  if (*start_ > 0.0) point.progress = 1.0 - point.transport / *start_;
  if (point.energy > 0.0) point.transport_per_joule = (*start_ - point.transport) / point.energy;
}

}  // namespace screed
