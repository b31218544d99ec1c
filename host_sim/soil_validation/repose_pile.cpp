// A collapsing tower.
#include "host_sim/soil_validation/repose_pile.h"
#include "host_sim/core/constants.h"
#include "host_sim/core/elementary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host_sim/physics/soil/soil_bed.h"
#include "host_sim/soil_validation/check_range.h"

namespace screed {
namespace {

/// Chord of the flank from the pile's middle outwards along (dx, dy).
double flank_deg(const HeightField& surface, const ReposeTest& test, double dx, double dy) {
  const double step = 0.1 * test.cell_m;
  const double top = surface.at(test.centre_x_m, test.centre_y_m).height;
  double high = 0.0;
  double low = 0.0;
  const int steps = static_cast<int>(0.5 * test.size_m / step);
  for (int i = 0; i < steps; ++i) {
    const double distance = i * step;
    const double height =
        surface.at(test.centre_x_m + distance * dx, test.centre_y_m + distance * dy).height;
    if (height >= 0.75 * top) high = distance;
    if (height >= 0.25 * top) low = distance;
  }
  return portable::atan2(0.5 * top, low - high) / kDegree;
}

void tap(SoilBed& bed, const ReposeTest& test) {
  constexpr double kThickness_m = 0.02;
  Footprint plate = Footprint::disc(test.radius_m + 2.0 * test.cell_m, kThickness_m);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << test.centre_x_m, test.centre_y_m,
      test.height_m + 0.5 * kThickness_m - test.tap_m;
  plate.set_pose(pose);
  FootprintMotion motion;
  motion.mass_kg = std::numeric_limits<double>::infinity();
  ContactMemory memory;
  bed.press(plate, motion, 1e-3, memory);
  bed.end_step();
}

}  // namespace

ReposeResult collapse(const ReposeTest& test) {
  check_range("repose", "cell", test.cell_m, 0.0005, 0.1);
  check_range("repose", "size", test.size_m, 0.1, 10.0);
  check_range("repose", "height", test.height_m, 1e-4, 10.0);
  check_range("repose", "radius", test.radius_m, test.cell_m, test.size_m);
  const int nodes = static_cast<int>(std::lround(test.size_m / test.cell_m)) + (test.wrap ? 0 : 1);
  const auto tower = [&](double x, double y) {
    double dx = x - test.centre_x_m;
    double dy = y - test.centre_y_m;
    if (test.wrap) {
      dx = std::remainder(dx, nodes * test.cell_m);
      dy = std::remainder(dy, nodes * test.cell_m);
    }
    return portable::hypot(dx, dy) <= test.radius_m ? test.height_m : 0.0;
  };
  SoilBed bed(HeightField::from_function(nodes, nodes, test.cell_m, test.wrap, tower), test.soil);
  const int64_t before = bed.surface().height_sum();
  if (test.tap_m > 0.0) tap(bed, test);
  const int64_t moves = bed.relax_slopes();
  return {moves,
          before - bed.surface().height_sum() - bed.balance().compacted - bed.balance().in_transit,
          repose_excess_units(bed.surface(), test.soil.repose_deg),
          flank_deg(bed.surface(), test, 1.0, 0.0),
          flank_deg(bed.surface(), test, std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0),
          bed.surface()};
}

double repose_excess_units(const HeightField& surface, double repose_deg) {
  const double straight = portable::tan(repose_deg * kDegree) * surface.spacing_m() / kHeightUnit_m;
  double worst = -std::numeric_limits<double>::infinity();
  for (int iy = 0; iy < surface.ny(); ++iy) {
    for (int ix = 0; ix < surface.nx(); ++ix) {
      for (const auto& [dx, dy] :
           {std::pair(1, 0), std::pair(0, 1), std::pair(1, 1), std::pair(-1, 1)}) {
        int x = ix + dx;
        int y = iy + dy;
        if (surface.wrap()) {
          x = (x + surface.nx()) % surface.nx();
          y %= surface.ny();
        } else if (x < 0 || x >= surface.nx() || y >= surface.ny()) {
          continue;
        }
        const double limit = dx != 0 && dy != 0 ? straight * std::numbers::sqrt2 : straight;
        const double difference =
            std::abs(static_cast<double>(surface.node(ix, iy)) - surface.node(x, y));
        worst = std::max(worst, difference - limit);
      }
    }
  }
  return worst;
}

}  // namespace screed
