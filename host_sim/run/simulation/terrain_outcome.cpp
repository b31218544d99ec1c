// One way to measure, whoever asks.
#include "host_sim/run/simulation/terrain_outcome.h"

#include "host_sim/physics/terrain/low_pass.h"

namespace screed {
namespace {

TerrainFigures figures_of(const HeightField& surface, double flat_deg) {
  return {terrain_statistics(surface), flatness(surface, flat_deg),
          robot_scale_figures(surface, flat_deg)};
}

TerrainFigures figures_of(const TerrainStatistics& statistics, const LevelingPoint& point) {
  return {statistics,
          point.flatness,
          {point.level_deviation, point.relief, point.roughness, point.robot_scale_flatness}};
}

}  // namespace

TerrainMeasure::TerrainMeasure(const Experiment& experiment)
    : grain_m_(experiment.map.of_particles() ? experiment.map.particle_radius_m : 0.0),
      flat_deg_(experiment.experiment.flatness_deg) {}

HeightField TerrainMeasure::surface(const HeightField& terrain) const {
  return is_filtered() ? low_passed(terrain, grain_m_) : terrain;
}

TerrainOutcome TerrainMeasure::outcome(const HeightField& before, const HeightField& after) const {
  return {figures_of(before, flat_deg_), figures_of(after, flat_deg_),
          terrain_change(before, after)};
}

TerrainOutcome TerrainMeasure::outcome(const HeightField& before, const HeightField& after,
                                       const LevelingPoint& first, const LevelingPoint& last) {
  const TerrainChange change = terrain_change(before, after);
  const TerrainStatistics statistics = terrain_statistics(before);
  return {figures_of(statistics, first),
          figures_of(change.is_none() ? statistics : terrain_statistics(after), last), change};
}

}  // namespace screed
