// Draws a scene on a canvas. Knows no window, no simulation and no clock; the same scenes give the
// same pixels.
#pragma once

#include <optional>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/layout.h"
#include "tools/screed/viewer/scene.h"

namespace screed::viewer {

class Drawing {
 public:
  /// Sizes below kMinWindowWidth_px, kMinWindowHeight_px are drawn as these.
  Drawing(int width_px, int height_px);

  void resize(int width_px, int height_px);
  Canvas& canvas() { return canvas_; }

  /// Where the ground is to be seen.
  const PixelBox& terrain_box() const { return layout_.terrain; }
  /// The bar that shows and sets the time.
  const PixelBox& timeline_box() const { return layout_.timeline; }
  /// The share of the run, 0..1, at a place on that bar.
  double share_at(double pixel_x) const;

  void draw(const Scene& scene);

 private:
  void draw_robot(const Scene& scene, const RobotMarker& robot, uint8_t state);
  void draw_trail(const Scene& scene, const std::vector<TrailPoint>& trail,
                  const RobotMarker& robot);
  void draw_trail_ends(const Scene& scene, const std::vector<TrailPoint>& trail,
                       const RobotMarker& robot);
  void draw_bed_edge(const Scene& scene);
  void draw_overlay(const Scene& scene);
  void draw_help(const std::vector<HelpLine>& help);
  void draw_timeline(const Scene& scene);
  void draw_text(const TextItem& text);
  Measure measure();

  Canvas canvas_;
  Layout layout_;
  std::optional<Status> drawn_;  ///< what the panel shows now
};

}  // namespace screed::viewer
