// What the grid world looks like at one moment: stacks and agents. The live view and the ray-traced
// picture draw it; it comes from a run or from a recording.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/grid/grid_terrain.h"

namespace screed {

class GridRun;

struct FrameAgent {
  int x;
  int y;
  bool carries;
};

struct GridFrame {
  GridTerrain terrain;
  std::vector<FrameAgent> agents;
  uint64_t cycle = 0;
  uint64_t units = 0;

  [[nodiscard]] uint64_t carried() const;
};

GridFrame frame_of(const GridRun& run);

}  // namespace screed
