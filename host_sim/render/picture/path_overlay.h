// What is drawn over a map: the driven path, the robot, and the legend that names its states.
#pragma once

#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/render/picture/terrain_picture.h"

namespace screed {

/// Draws the robot, over it path, start and end, cut off at the map's edge. `wrap`: as the
/// terrain's.
void draw_path_overlay(Canvas& canvas, const MapFrame& frame, bool wrap,
                       const PictureOptions& options);

/// The marks of a path's ends, of a radius in pixels.
void draw_path_start(Canvas& canvas, Pixel at, double radius_px);
void draw_path_end(Canvas& canvas, Pixel at, double radius_px);

/// The states that occur on a path, each once, in ascending order.
std::vector<size_t> states_on_paths(const PictureOptions& options);

/// The height that draw_legend() needs, in pixels; 0 when it draws nothing.
double legend_height_px(const PictureOptions& options);

/// Names the path's states and the markers beside the map; draws nothing when there is no path.
void draw_legend(Canvas& canvas, const MapFrame& frame, const PictureOptions& options);

}  // namespace screed
