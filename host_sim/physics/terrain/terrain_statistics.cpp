// One pass over nodes, one over cells, always in the same order.
#include "host_sim/physics/terrain/terrain_statistics.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <vector>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"

namespace screed {

namespace {

constexpr double kDegreesPerRadian = 180.0 / std::numbers::pi;

double slope_deg(double gradient) {
  return portable::atan(gradient) * kDegreesPerRadian;
}

/// |grad f| at the centre of every cell, row by row.
std::vector<double> centre_gradients(const HeightField& field) {
  std::vector<double> gradients;
  gradients.reserve(static_cast<size_t>(field.cells_x()) * static_cast<size_t>(field.cells_y()));
  for (int iy = 0; iy < field.cells_y(); ++iy) {
    for (int ix = 0; ix < field.cells_x(); ++ix) gradients.push_back(cell_gradient(field, ix, iy));
  }
  return gradients;
}

double mean_height(const HeightField& field) {
  return static_cast<double>(field.height_sum()) / (static_cast<double>(field.nx()) * field.ny());
}

void add_heights(const HeightField& field, TerrainStatistics& statistics) {
  Height lowest = field.node(0, 0);
  Height highest = lowest;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const Height height = field.node(ix, iy);
      lowest = std::min(lowest, height);
      highest = std::max(highest, height);
    }
  }
  statistics.lowest_m = lowest * kHeightUnit_m;
  statistics.highest_m = highest * kHeightUnit_m;
  statistics.mean_height_m = mean_height(field) * kHeightUnit_m;
  statistics.height_deviation_m = height_deviation_m(field);
}

void add_slopes(const HeightField& field, TerrainStatistics& statistics) {
  std::vector<double> slopes = centre_gradients(field);
  double sum = 0.0;
  double squares = 0.0;
  for (double& slope : slopes) {
    slope = slope_deg(slope);
    sum += slope;
    squares += slope * slope;
  }
  const auto count = static_cast<double>(slopes.size());
  statistics.mean_slope_deg = sum / count;
  statistics.rms_slope_deg = std::sqrt(squares / count);
  // Nearest rank, ceil(0.95 count), in integers.
  const size_t rank = (slopes.size() * 95 + 99) / 100;
  const auto p95 = slopes.begin() + static_cast<std::ptrdiff_t>(rank) - 1;
  std::nth_element(slopes.begin(), p95, slopes.end());
  statistics.p95_slope_deg = *p95;
  statistics.steepest_slope_deg = *std::max_element(p95, slopes.end());
}

}  // namespace

double height_deviation_m(const HeightField& field) {
  const double mean = mean_height(field);
  double squares = 0.0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double off = field.node(ix, iy) - mean;
      squares += off * off;
    }
  }
  const double count = static_cast<double>(field.nx()) * field.ny();
  return std::sqrt(squares / count) * kHeightUnit_m;
}

TerrainStatistics terrain_statistics(const HeightField& field) {
  TerrainStatistics statistics{};
  add_heights(field, statistics);
  add_slopes(field, statistics);
  return statistics;
}

double flatness(const HeightField& field, double epsilon_deg) {
  if (!(epsilon_deg >= 0.0 && epsilon_deg <= 89.0)) {
    std::ostringstream message;
    message << "flatness: epsilon_deg = " << epsilon_deg << "; allowed: 0 to 89";
    throw InputError(message.str());
  }
  const double epsilon = portable::tan(epsilon_deg / kDegreesPerRadian) + gradient_rounding(field);
  const std::vector<double> gradients = centre_gradients(field);
  const auto level = std::count_if(gradients.begin(), gradients.end(),
                                   [epsilon](double gradient) { return gradient <= epsilon; });
  return static_cast<double>(level) / static_cast<double>(gradients.size());
}

// Volumes are summed in integers, so that they are exact.

TerrainChange terrain_change(const HeightField& before, const HeightField& after) {
  if (before.nx() != after.nx() || before.ny() != after.ny() ||
      before.spacing_m() != after.spacing_m() || before.wrap() != after.wrap()) {
    throw InputError("terrain change: the terrains before and after differ in their grid");
  }
  int64_t cut = 0;
  int64_t fill = 0;
  int64_t lowest = 0;
  int64_t highest = 0;
  const size_t nodes = static_cast<size_t>(before.nx()) * static_cast<size_t>(before.ny());
  for (size_t node = 0; node < nodes; ++node) {
    const int64_t change = int64_t{after.node(node)} - before.node(node);
    if (change < 0) {
      cut -= change;
    } else {
      fill += change;
    }
    lowest = std::min(lowest, change);
    highest = std::max(highest, change);
  }
  const double unit_m3 = kHeightUnit_m * before.spacing_m() * before.spacing_m();
  return {static_cast<double>(cut) * unit_m3, static_cast<double>(fill) * unit_m3,
          static_cast<double>(-lowest) * kHeightUnit_m,
          static_cast<double>(highest) * kHeightUnit_m};
}

}  // namespace screed
