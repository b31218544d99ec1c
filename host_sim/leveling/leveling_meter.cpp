// One low-pass serves all figures.
#include "host_sim/leveling/leveling_meter.h"

#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>

#include "host_sim/core/constants.h"
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

// A transportation problem between blocks, solved by LEMON's network simplex.

namespace {

using lemon::SmartDigraph;
using Solver = lemon::NetworkSimplex<SmartDigraph, int64_t, int64_t>;

constexpr double kVolumeUnits = 0x1p40;  ///< all that has to be moved, in units of a plan
constexpr double kLengthUnits = 0x1p30;  ///< the bed's longer side in units of cost

/// Where block number k of `blocks` begins along an axis of so many nodes.
int first_node(int k, int blocks, int nodes) {
  return static_cast<int>(int64_t{k} * nodes / blocks);
}

/// How far apart along one side; on wrapped terrain the shorter way.
double apart(double a, double b, double side_m, bool wrap) {
  const double direct = std::abs(a - b);
  return wrap ? std::min(direct, side_m - direct) : direct;
}

/// Nodes from x0 and y0 to before x1 and y1.
struct NodeRange {
  int x0;
  int x1;
  int y0;
  int y1;
};

/// Adds these nodes as a block; `mean`: of the heights of the surface, in their units.
void add_block(const HeightField& surface, const NodeRange& range, double mean,
               GroundBlocks& ground) {
  const auto [x0, x1, y0, y1] = range;
  const double unit_m3 = kHeightUnit_m * surface.spacing_m() * surface.spacing_m();
  GroundBlock block;
  block.x_m = 0.5 * (surface.node_x(x0) + surface.node_x(x1 - 1));
  block.y_m = 0.5 * (surface.node_y(y0) + surface.node_y(y1 - 1));
  double excess = 0.0;
  double error = 0.0;
  for (int iy = y0; iy < y1; ++iy) {
    const double dy = surface.node_y(iy) - block.y_m;
    for (int ix = x0; ix < x1; ++ix) {
      const double dx = surface.node_x(ix) - block.x_m;
      const double above = surface.node(ix, iy) - mean;
      excess += above;
      error += std::abs(above) * std::sqrt(dx * dx + dy * dy);
    }
  }
  block.excess_m3 = excess * unit_m3;
  ground.w1_error += error * unit_m3;
  ground.blocks.push_back(block);
}

/// Excess of each block in units of kVolumeUnits a `volume_m3`; they add up to 0.
std::vector<int64_t> supplies(const std::vector<GroundBlock>& blocks, double volume_m3) {
  std::vector<int64_t> units;
  units.reserve(blocks.size());
  int64_t rest = 0;
  for (const GroundBlock& block : blocks) {
    units.push_back(std::llround(block.excess_m3 / volume_m3 * kVolumeUnits));
    rest += units.back();
  }
  // What rounding has left over, some 10^-10 of the whole, goes where it matters least.
  *std::max_element(units.begin(), units.end()) -= rest;
  return units;
}

/// The cheapest plan's cost; `cost_of(share)` of a distance, both in sides of the bed.
template <class CostOf>
double solve(const GroundBlocks& ground, CostOf cost_of) {
  double volume_m3 = 0.0;
  for (const GroundBlock& block : ground.blocks) volume_m3 += std::max(0.0, block.excess_m3);
  if (!(volume_m3 > 0.0)) return 0.0;
  const std::vector<int64_t> supply = supplies(ground.blocks, volume_m3);
  const double side_m = std::max(ground.width_m, ground.length_m);

  SmartDigraph graph;
  std::vector<int> from;
  std::vector<int> to;
  for (size_t i = 0; i < supply.size(); ++i) {
    graph.addNode();
    if (supply[i] != 0) (supply[i] > 0 ? from : to).push_back(static_cast<int>(i));
  }
  graph.reserveArc(static_cast<int>(from.size() * to.size()));
  std::vector<int64_t> costs;
  costs.reserve(from.size() * to.size());
  for (const int i : from) {
    const GroundBlock& source = ground.blocks[static_cast<size_t>(i)];
    for (const int j : to) {
      const GroundBlock& sink = ground.blocks[static_cast<size_t>(j)];
      const double dx = apart(source.x_m, sink.x_m, ground.width_m, ground.wrap);
      const double dy = apart(source.y_m, sink.y_m, ground.length_m, ground.wrap);
      graph.addArc(SmartDigraph::nodeFromId(i), SmartDigraph::nodeFromId(j));
      costs.push_back(std::llround(cost_of(std::sqrt(dx * dx + dy * dy) / side_m) * kLengthUnits));
    }
  }
  SmartDigraph::ArcMap<int64_t> cost_map(graph);
  for (size_t arc = 0; arc < costs.size(); ++arc)
    cost_map[SmartDigraph::arcFromId(static_cast<int>(arc))] = costs[arc];
  SmartDigraph::NodeMap<int64_t> supply_map(graph);
  for (size_t i = 0; i < supply.size(); ++i)
    supply_map[SmartDigraph::nodeFromId(static_cast<int>(i))] = supply[i];

  Solver solver(graph);
  if (solver.costMap(cost_map).supplyMap(supply_map).run() != Solver::OPTIMAL)
    throw std::logic_error("a transport whose supplies add up to 0 has a solution");
  double units = 0.0;
  for (size_t arc = 0; arc < costs.size(); ++arc) {
    const int64_t flow = solver.flow(SmartDigraph::arcFromId(static_cast<int>(arc)));
    units += static_cast<double>(flow) * static_cast<double>(costs[arc]);
  }
  return units / kVolumeUnits / kLengthUnits * volume_m3;
}

}  // namespace

GroundBlocks ground_blocks(const HeightField& surface, int blocks) {
  if (blocks < 1) {
    std::ostringstream message;
    message << "transport: blocks = " << blocks << "; allowed: 1 or more";
    throw InputError(message.str());
  }
  GroundBlocks ground;
  ground.width_m = surface.nx() * surface.spacing_m();
  ground.length_m = surface.ny() * surface.spacing_m();
  ground.wrap = surface.wrap();
  const int longer = std::max(surface.nx(), surface.ny());
  const auto along = [&](int nodes) {
    const auto wanted = std::lround(static_cast<double>(blocks) * nodes / longer);
    return static_cast<int>(std::clamp<long>(wanted, 1, nodes));
  };
  const int blocks_x = along(surface.nx());
  const int blocks_y = along(surface.ny());
  const double mean = static_cast<double>(surface.height_sum()) /
                      (static_cast<double>(surface.nx()) * surface.ny());
  for (int y = 0; y < blocks_y; ++y) {
    for (int x = 0; x < blocks_x; ++x) {
      const NodeRange range{
          first_node(x, blocks_x, surface.nx()), first_node(x + 1, blocks_x, surface.nx()),
          first_node(y, blocks_y, surface.ny()), first_node(y + 1, blocks_y, surface.ny())};
      add_block(surface, range, mean, ground);
    }
  }
  return ground;
}

double least_transport(const GroundBlocks& ground) {
  const double side_m = std::max(ground.width_m, ground.length_m);
  return solve(ground, [](double distance) { return distance; }) * side_m;
}

double least_squared_transport(const GroundBlocks& ground) {
  const double side_m = std::max(ground.width_m, ground.length_m);
  return solve(ground, [](double distance) { return distance * distance; }) * side_m * side_m;
}

// All figures of a point.

namespace {

void set_cost(const LevelingCost& cost, LevelingPoint& point) {
  point.time = cost.time_s;
  point.distance = cost.distance_m;
  point.energy = cost.energy_j;
  point.slip = cost.traversability.slip;
  point.stuck = cost.traversability.stuck;
  point.tilted = cost.traversability.tilted;
  point.off_site = cost.traversability.off_site;
  point.returning = cost.traversability.returning;
  point.visited = cost.traversability.visited;
}

}  // namespace

LevelingPoint LevelingMeter::measure(const HeightField& surface, const LevelingCost& cost,
                                     bool with_transport) {
  const RobotScaleFigures robot_scale = robot_scale_figures(surface, flat_deg_);
  LevelingPoint point;
  point.level_deviation = robot_scale.level_deviation_m;
  point.relief = robot_scale.relief_m;
  point.roughness = robot_scale.roughness_m;
  point.robot_scale_flatness = robot_scale.flatness;
  point.flatness = flatness(surface, flat_deg_);
  point.height_deviation = height_deviation_m(surface);
  set_cost(cost, point);
  if (with_transport) add_transport(surface, point);
  return point;
}

LevelingPoint LevelingMeter::unchanged(const LevelingPoint& earlier, const LevelingCost& cost) {
  LevelingPoint point;
  point.level_deviation = earlier.level_deviation;
  point.relief = earlier.relief;
  point.roughness = earlier.roughness;
  point.robot_scale_flatness = earlier.robot_scale_flatness;
  point.flatness = earlier.flatness;
  point.height_deviation = earlier.height_deviation;
  set_cost(cost, point);
  return point;
}

void LevelingMeter::add_transport(const HeightField& surface, LevelingPoint& point) {
  const GroundBlocks ground = ground_blocks(surface);
  point.transport = least_transport(ground);
  point.transport_error = ground.w1_error;
  point.transport_squared = least_squared_transport(ground);
  if (!start_.has_value()) start_ = point.transport;
  if (*start_ > 0.0) point.progress = 1.0 - point.transport / *start_;
  if (point.energy > 0.0) point.transport_per_joule = (*start_ - point.transport) / point.energy;
}

}  // namespace screed
