// A grid of heights as it is handed to and from sessions and pictures: plain data, without the
// height field's lookups.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace screed {

/// A grid of integer heights: heights[iy * nx + ix] stands at (origin_x + ix * spacing, origin_y +
/// iy * spacing) and is that many height units high.
struct HeightMapGeometry {
  std::uint32_t nx = 0;
  std::uint32_t ny = 0;
  double unit_m = 0;     ///< metres of one height unit
  double spacing_m = 0;  ///< metres between neighbours, both ways
  double origin_x_m = 0;
  double origin_y_m = 0;
  bool wrap = false;   ///< the map repeats in both directions
  bool walls = false;  ///< it has walls along its edges

  bool operator==(const HeightMapGeometry&) const = default;
};

struct HeightMapView {
  HeightMapGeometry geometry;
  std::span<const std::int32_t> heights;  ///< nx * ny of them
};

struct HeightMap {
  HeightMapGeometry geometry;
  std::vector<std::int32_t> heights;

  HeightMapView view() const { return {geometry, heights}; }
  bool operator==(const HeightMap&) const = default;
};

/// What a tick did to one height of a map.
struct HeightChange {
  std::uint32_t node = 0;  ///< iy * nx + ix
  std::int32_t by = 0;     ///< height units
};

/// In height units.
struct HeightExtremes {
  std::int32_t lowest = 0;
  std::int32_t highest = 0;
};

}  // namespace screed
