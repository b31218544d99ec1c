// The ground from above as an image, without the furniture around it: for pictures that put several
// together.
#pragma once

#include <cstdint>
#include <vector>

#include "host_sim/render/picture/map_frame.h"

namespace screed {

/// The ground as an image of width x height pixels, its rows from the north.
struct MapImage {
  MapRectangle ground;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

}  // namespace screed
