#include "host_sim/standin/coarse_ground.h"

#include <cmath>

namespace screed {

HeightField coarse_ground(const HeightField& ground, double spacing_m) {
  constexpr double kAsCoarse = 0.75;
  if (ground.spacing_m() >= kAsCoarse * spacing_m) return ground;
  const double width = ground.x_max() - ground.x_min();
  const double height = ground.y_max() - ground.y_min();
  const int cells = std::max(1, static_cast<int>(std::lround(width / spacing_m)));
  const double edge = width / cells;
  const int rows = std::max(1, static_cast<int>(std::lround(height / edge)));
  const int more = ground.wrap() ? 0 : 1;  // nodes than cells
  // As many places in a cell as it has cells of the ground, in their middles where they fit.
  const int points = std::max(1, static_cast<int>(std::lround(edge / ground.spacing_m())));
  HeightField coarse = HeightField::from_function(
      cells + more, rows + more, edge, ground.wrap(), [&](double x, double y) {
        double sum = 0.0;
        for (int i = 0; i < points; ++i) {
          for (int j = 0; j < points; ++j) {
            const auto aside = [&](int k) { return edge * ((k + 0.5) / points - 0.5); };
            sum += ground.at(x + aside(i), y + aside(j)).height;
          }
        }
        return sum / (points * points);
      });
  if (ground.edge() == BedEdge::kWalled) coarse.add_walls();
  return coarse;
}

}  // namespace screed
