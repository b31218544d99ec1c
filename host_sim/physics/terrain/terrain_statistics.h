// How rough a terrain is, in numbers: heights, slopes, and the thesis' measure of flatness.
#pragma once

#include <cmath>

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
  double steepest_slope_deg;  ///< that of the steepest cell
};

/// The slope of a cell at its centre, as rise over run. 0 <= ix < cells_x, 0 <= iy < cells_y: not
/// checked.
inline double cell_gradient(const HeightField& field, int ix, int iy) {
  const CellHeights c = field.cell(ix, iy);
  const double diagonal = static_cast<double>(c.north_east) - c.south_west;
  const double other = static_cast<double>(c.north_west) - c.south_east;
  const double along_x = 0.5 * (diagonal - other);
  const double along_y = 0.5 * (diagonal + other);
  return std::sqrt(along_x * along_x + along_y * along_y) * (kHeightUnit_m / field.spacing_m());
}

/// By how much cell_gradient() can be off because heights are rounded to the unit: half a unit at
/// each corner adds up to one unit over the cell at most.
inline double gradient_rounding(const HeightField& field) {
  return kHeightUnit_m / field.spacing_m();
}

TerrainStatistics terrain_statistics(const HeightField& field);

/// TerrainStatistics::height_deviation_m alone.
double height_deviation_m(const HeightField& field);

/// The share (0..1) of cells that are level within epsilon: |grad f| <= tan(epsilon_deg), the
/// definition of flatness in section 4.1 of the thesis; 1 = leveled. A slope that exceeds epsilon
/// by no more than gradient_rounding() counts as level, so that a ramp of epsilon does.
/// Throws InputError unless epsilon_deg is 0..89.
double flatness(const HeightField& field, double epsilon_deg);

// What a run has done to a terrain, in numbers: volumes and depths.

/// From one terrain to another on the same grid. Every node stands for one cell of it.
struct TerrainChange {
  double cut_m3 = 0.0;          ///< by which the ground is lower, where it is lower
  double fill_m3 = 0.0;         ///< by which it is higher, where it is higher
  double deepest_cut_m = 0.0;   ///< >= 0
  double deepest_fill_m = 0.0;  ///< >= 0
  /// Whether every height is what it was.
  [[nodiscard]] bool is_none() const { return cut_m3 == 0.0 && fill_m3 == 0.0; }
  /// The ground that lies elsewhere now. The rest of the cut is compacted (or has left the bed),
  /// the rest of the fill has loosened.
  [[nodiscard]] double moved_m3() const { return cut_m3 < fill_m3 ? cut_m3 : fill_m3; }
};

/// Throws InputError when the two differ in their grid.
TerrainChange terrain_change(const HeightField& before, const HeightField& after);

}  // namespace screed
