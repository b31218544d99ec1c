// What a session says about its run as a whole, and how terrain is handed to and from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "firmware/parameters/board_constants.h"
#include "firmware/parameters/parameters.h"
#include "hal/sample.h"
#include "host_sim/ground_station/station/command_key.h"

namespace screed {

struct SessionInfo {
  std::string program_version;  ///< not part of the content hash
  std::string experiment_name;  ///< not part of the content hash
  std::string experiment_text;  ///< the whole INI text that was in force, overrides applied; any
                                ///< size, no NUL byte
  std::uint64_t seed = 0;
  std::uint32_t tick_rate_hz = kTickRate_hz;
  std::string board_name;
  BoardConstants board{};
  Parameters parameters;
  Credentials credentials = credentials_of(test_key());
};

/// A grid of integer heights: heights[iy * nx + ix] stands at (origin_x + ix * spacing, origin_y +
/// iy * spacing) and is that many height units high.
struct HeightMapGeometry {
  std::uint32_t nx = 0;
  std::uint32_t ny = 0;
  double unit_m = 0;     ///< metres of one height unit
  double spacing_m = 0;  ///< metres between neighbours, both ways
  double origin_x_m = 0;
  double origin_y_m = 0;
  bool wrap = false;  ///< the map repeats in both directions
};

struct HeightMapView {
  HeightMapGeometry geometry;
  std::span<const std::int32_t> heights;  ///< nx * ny of them
};

struct HeightMap {
  HeightMapGeometry geometry;
  std::vector<std::int32_t> heights;

  HeightMapView view() const { return {geometry, heights}; }
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
