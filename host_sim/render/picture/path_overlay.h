// What is drawn over a map: the driven path, the robot, and the legend that names its states.
#pragma once

#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/render/picture/terrain_picture.h"

namespace screed {

/// Draws path, start and end, and robot, cut off at the map's edge. `wrap`: as the terrain's.
void draw_path_overlay(Canvas& canvas, const MapFrame& frame, bool wrap,
                       const PictureOptions& options);

/// The height that draw_legend() needs, in pixels; 0 when it draws nothing.
double legend_height_px(const PictureOptions& options);

/// Names the states and markers beside the map; draws nothing when there is no path.
void draw_legend(Canvas& canvas, const MapFrame& frame, const PictureOptions& options);

}  // namespace screed
