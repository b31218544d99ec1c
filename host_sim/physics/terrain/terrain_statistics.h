// How rough a terrain is, in numbers: heights, slopes, and the thesis' measure of flatness.
#pragma once

#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// Heights over all nodes, in metres; slopes over all cells, in degrees, each cell's taken at its
/// centre. The same field gives the same bits.
struct TerrainStatistics {
  double lowest_m;
  double highest_m;
  double mean_height_m;
  double height_deviation_m;  ///< standard deviation (of the whole population of nodes)
  double mean_slope_deg;
  double rms_slope_deg;
  double p95_slope_deg;       ///< the smallest slope that at least 95 % of the cells do not exceed
  double max_slope_deg;       ///< at cell centres
  double steepest_slope_deg;  ///< anywhere: HeightField::steepest_gradient(), at a cell corner
};

TerrainStatistics terrain_statistics(const HeightField& field);

/// The share (0..1) of cells that are level within epsilon: |grad f| <= tan(epsilon_deg), the
/// definition of flatness in section 4.1 of the thesis; 1 = leveled.
/// Throws InputError unless epsilon_deg is 0..89.
double flatness(const HeightField& field, double epsilon_deg);

}  // namespace screed
