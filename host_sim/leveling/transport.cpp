// A transportation problem between blocks, solved by LEMON's network simplex.
#include "host_sim/leveling/transport.h"

#include <lemon/network_simplex.h>
#include <lemon/smart_graph.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <stdexcept>

#include "host_sim/core/errors.h"

namespace screed {
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

}  // namespace screed
