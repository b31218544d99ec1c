// The panel beside the terrain: figures of a run.
#pragma once

#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/scene.h"

namespace screed::viewer {

/// What is written in the panel, and where.
struct PanelLayout {
  struct Mark {
    PixelBox box;
    Color color;
    bool round;  ///< a dot, else a piece of path
  };
  std::vector<TextItem> texts;
  std::vector<Mark> marks;
  std::vector<double> rules;  ///< y of the lines between sections
  double left = 0.0;          ///< of all of them
  double right = 0.0;
};

/// Fits what it can: rows move together first, then the least important ones are left out, which a
/// line says.
PanelLayout panel_layout(const Layout& layout, const Status& status, const Measure& measure);

void draw_status_panel(Canvas& canvas, const Layout& layout, const Status& status);

}  // namespace screed::viewer
