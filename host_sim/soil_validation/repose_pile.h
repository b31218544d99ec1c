// A tower of loose material that collapses: how steep what remains is, and whether all of it is
// still there.
#pragma once

#include <cstdint>

#include "host_sim/physics/soil/soil_parameters.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

struct ReposeTest {
  SoilParameters soil;
  double cell_m = 0.005;
  double size_m = 0.6;     ///< of the bed's side
  double radius_m = 0.06;  ///< of the tower
  double height_m = 0.15;
  double centre_x_m = 0.0;
  double centre_y_m = 0.0;
  bool wrap = false;
  double tap_m = 1e-4;  ///< a plate taps the tower's top by so much first; 0: untouched
};

struct ReposeResult {
  int64_t moves;
  int64_t volume_error;       ///< units of height times cells: 0
  double excess_units;        ///< of the steepest pair of neighbours above the angle of repose
  double slope_axis_deg;      ///< of the pile's flank along the grid's axes: chord between a
                              ///< quarter and three quarters of its height
  double slope_diagonal_deg;  ///< and along its diagonals
  HeightField surface;
};

/// Throws InputError for figures out of range.
ReposeResult collapse(const ReposeTest& test);

/// By how many units of height the steepest pair of neighbours (straight or diagonal, across a
/// wrapped edge too) exceeds a slope of `repose_deg`; negative when none does.
double repose_excess_units(const HeightField& surface, double repose_deg);

}  // namespace screed
