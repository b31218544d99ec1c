// What a run did to its terrain: how the surface is measured, and what comes of it.
#pragma once

#include "host_sim/leveling/leveling_point.h"
#include "host_sim/leveling/robot_scale.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/terrain_change.h"
#include "host_sim/physics/terrain/terrain_statistics.h"
#include "host_sim/run/experiment/experiment.h"

namespace screed {

/// A terrain in figures.
struct TerrainFigures {
  TerrainStatistics heights;
  double flatness = 0.0;  ///< share of flat cells, 0..1
  RobotScaleFigures robot_scale;
};

/// The terrain before and after a run. Heights of particle beds are those of TerrainMeasure.
struct TerrainOutcome {
  TerrainFigures before;
  TerrainFigures after;
  TerrainChange change;
};

/// How the terrain of an experiment is measured, for its summary and its pictures.
class TerrainMeasure {
 public:
  /// Of a terrain without particles, flat up to 5 degrees.
  TerrainMeasure() = default;
  explicit TerrainMeasure(const Experiment& experiment);

  /// The surface that counts. On a bed of particles a Gaussian low-pass, with the radius of a
  /// particle as its standard deviation, takes away single stones: their flanks are steep whatever
  /// the bed is like. Any other terrain is taken as it is.
  HeightField surface(const HeightField& terrain) const;
  /// Whether surface() changes anything.
  bool is_filtered() const { return grain_m_ > 0.0; }
  /// Slope up to which a cell is flat.
  double flat_deg() const { return flat_deg_; }
  /// The figures of two surfaces, each from surface().
  TerrainOutcome outcome(const HeightField& before, const HeightField& after) const;
  /// The same of surfaces that have been measured already, as the first and the last point of a
  /// leveling curve.
  static TerrainOutcome outcome(const HeightField& before, const HeightField& after,
                                const LevelingPoint& first, const LevelingPoint& last);

 private:
  double grain_m_ = 0.0;  ///< 0: no particles
  double flat_deg_ = 5.0;
};

}  // namespace screed
