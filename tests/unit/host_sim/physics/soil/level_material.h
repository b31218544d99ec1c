// A level field of loose material and what tests of it need.
#pragma once

#include <cmath>

#include "host_sim/physics/soil/material_flow.h"

namespace screed {

inline constexpr double kSpacing_m = 0.01;
inline constexpr double kRepose_deg = 30.0;

inline MaterialFlow level(int nodes = 21, bool wrap = false, const Compaction& compaction = {}) {
  return {HeightField(nodes, nodes, kSpacing_m, wrap), kRepose_deg, compaction};
}

/// The greatest stable difference in height between neighbours, in units.
inline Height stable(double distance_m) {
  return static_cast<Height>(
      std::floor(std::tan(kRepose_deg * M_PI / 180.0) * distance_m / kHeightUnit_m));
}

inline int64_t volume(const MaterialFlow& flow) {
  return flow.balance().now;
}

inline Height height(const MaterialFlow& flow, int ix, int iy) {
  return flow.grid().height(flow.grid().node(ix, iy));
}

/// A footprint of one node, pressed down by so many units.
inline void press(MaterialFlow& flow, int ix, int iy, Height units, double velocity_x = 0.0,
                  double velocity_y = 0.0) {
  flow.begin_footprint({{velocity_x, velocity_y}});
  flow.cover(flow.grid().place(ix, iy));
  flow.sink(flow.grid().place(ix, iy), units);
}

}  // namespace screed
