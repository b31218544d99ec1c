// One low-pass serves all figures.
#include "host_sim/leveling/robot_scale.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "host_sim/core/display_units.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/low_pass.h"
#include "host_sim/physics/terrain/terrain_statistics.h"

namespace screed {
namespace {

/// The share of cells of the low-passed surface that rise by no more than `limit` (rise over run)
/// at their centre.
double share_within(const FilteredHeights& heights, const HeightField& field, double limit) {
  const auto columns = static_cast<size_t>(field.nx());
  size_t within = 0;
  for (int iy = 0; iy < field.cells_y(); ++iy) {
    const double* const south = heights.low_m.data() + static_cast<size_t>(iy) * columns;
    const size_t row_north = iy + 1 == field.ny() ? 0 : static_cast<size_t>(iy) + 1;
    const double* const north = heights.low_m.data() + row_north * columns;
    for (int ix = 0; ix < field.cells_x(); ++ix) {
      const auto west = static_cast<size_t>(ix);
      const size_t east = ix + 1 == field.nx() ? 0 : west + 1;
      const double diagonal = north[east] - south[west];
      const double other = north[west] - south[east];
      const double along_x = 0.5 * (diagonal - other) / field.spacing_m() + heights.plane.slope_x;
      const double along_y = 0.5 * (diagonal + other) / field.spacing_m() + heights.plane.slope_y;
      if (along_x * along_x + along_y * along_y <= limit * limit) ++within;
    }
  }
  return static_cast<double>(within) /
         (static_cast<double>(field.cells_x()) * static_cast<double>(field.cells_y()));
}

}  // namespace

RobotScaleFigures robot_scale_figures(const HeightField& field, double flat_deg) {
  if (!(flat_deg >= 0.0 && flat_deg <= 89.0)) {
    std::ostringstream message;
    message << "robot scale: flat_deg = " << flat_deg << "; allowed: 0 to 89";
    throw InputError(message.str());
  }
  const FilteredHeights heights = filter_heights(field, kRobotScale_m);
  double surface = 0.0;
  double surface_squared = 0.0;
  double relief = 0.0;
  double roughness = 0.0;
  size_t node = 0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix, ++node) {
      const double low = heights.low_m[node];
      const double rest = heights.heights_m[node] - low;
      // Above the middle of the bed, which its mean height is near: next to nothing cancels.
      const double above =
          low + heights.plane.slope_x * field.node_x(ix) + heights.plane.slope_y * field.node_y(iy);
      surface += above;
      surface_squared += above * above;
      relief += low * low;
      roughness += rest * rest;
    }
  }
  const auto count = static_cast<double>(heights.low_m.size());
  const double mean = surface / count;
  const double limit = portable::tan(flat_deg / kDegPerRad) + gradient_rounding(field);
  return {std::sqrt(std::max(0.0, surface_squared / count - mean * mean)),
          std::sqrt(relief / count), std::sqrt(roughness / count),
          share_within(heights, field, limit)};
}

}  // namespace screed
