// The panel beside the ground: time, what the robot does, what the terrain has become.
#pragma once

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/scene.h"

namespace screed::viewer {

/// Fills the right-hand side of the canvas.
void draw_status_panel(Canvas& canvas, const Status& status);

}  // namespace screed::viewer
