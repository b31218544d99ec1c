// The mean plane goes before the filter, so that a slope does not bend at the edges of its bed.
#include "host_sim/physics/terrain/low_pass.h"

#include <cmath>
#include <sstream>

#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/gaussian_filter.h"

namespace screed {

MeanPlane mean_plane(const HeightField& field) {
  const double count = static_cast<double>(field.nx()) * field.ny();
  MeanPlane plane;
  plane.height_m = static_cast<double>(field.height_sum()) / count * kHeightUnit_m;
  if (field.wrap()) return plane;
  // The nodes lie symmetrically about (0, 0), so that the three equations separate.
  double moment_x = 0.0;
  double moment_y = 0.0;
  double squares_x = 0.0;
  double squares_y = 0.0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    const double y = field.node_y(iy);
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double x = field.node_x(ix);
      const double height = field.node(ix, iy) * kHeightUnit_m - plane.height_m;
      moment_x += x * height;
      moment_y += y * height;
      squares_x += x * x;
      squares_y += y * y;
    }
  }
  plane.slope_x = moment_x / squares_x;
  plane.slope_y = moment_y / squares_y;
  return plane;
}

FilteredHeights filter_heights(const HeightField& field, double sigma_m) {
  if (!(sigma_m >= 1e-4 && sigma_m <= 100.0)) {
    std::ostringstream message;
    message << "low-pass: sigma_m = " << sigma_m << "; allowed: 0.0001 to 100";
    throw InputError(message.str());
  }
  FilteredHeights result;
  result.plane = mean_plane(field);
  result.heights_m.reserve(static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny()));
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      result.heights_m.push_back(field.node(ix, iy) * kHeightUnit_m -
                                 result.plane.at(field.node_x(ix), field.node_y(iy)));
    }
  }
  result.low_m = result.heights_m;
  gaussian_filter(result.low_m, field.nx(), field.ny(), sigma_m / field.spacing_m(),
                  field.wrap() ? FilterEdge::kWrapped : FilterEdge::kReflected);
  return result;
}

HeightField low_passed(const HeightField& field, double sigma_m) {
  const FilteredHeights heights = filter_heights(field, sigma_m);
  HeightField result(field.nx(), field.ny(), field.spacing_m(), field.wrap());
  size_t node = 0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double height =
          heights.plane.at(field.node_x(ix), field.node_y(iy)) + heights.low_m[node++];
      result.set_node(ix, iy, static_cast<Height>(std::lround(height / kHeightUnit_m)));
    }
  }
  result.refresh_bounds();
  return result;
}

}  // namespace screed
