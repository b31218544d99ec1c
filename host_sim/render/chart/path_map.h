// A map of paths seen from above, true to scale, as part of an SVG: each path with its colour, its
// start and its end, over an image of the ground where there is one.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/render/chart/svg.h"
#include "host_sim/render/picture/map_frame.h"

namespace screed {

struct MapPath {
  std::string label;
  std::vector<Pixel> points;          ///< x east, y north, m
  std::vector<std::size_t> breaks{};  ///< points before which the line breaks, in order
  std::optional<Color> color{};       ///< none: line_color() of its place among the paths
};

struct PathMap {
  std::string title;
  std::vector<MapPath> paths;
  std::optional<MapImage> image;
  std::optional<ColorScale> scale;  ///< of the image; a colour bar below the map
  /// What the map shows; none: all paths and all of the image.
  std::optional<MapRectangle> view;
};

/// Draws map, axes in metres, legend and colour bar into the box. Throws InputError when there is
/// nothing to draw or a place is no number.
void draw_path_map(Svg& svg, const PathMap& map, const PixelBox& box);

}  // namespace screed
