// Draws a scene on a canvas. Knows no window, no simulation and no clock; the same scenes give the
// same pixels.
#pragma once

#include <optional>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/scene.h"

namespace screed::viewer {

class Drawing {
 public:
  static constexpr int kMinWidth = 640;
  static constexpr int kMinHeight = 420;

  /// Smaller sizes are drawn as the least.
  Drawing(int width_px, int height_px);

  void resize(int width_px, int height_px);
  Canvas& canvas() { return canvas_; }

  /// Where the ground is to be seen.
  PixelBox terrain_box() const;
  /// The bar that shows and sets the time.
  PixelBox timeline_box() const;
  /// The share of the run, 0..1, at a place on that bar.
  double share_at(double pixel_x) const;

  void draw(const Scene& scene);

 private:
  void draw_trail(const Scene& scene);
  void draw_robot(const Scene& scene);
  void draw_bed_edge(const Scene& scene);
  void draw_scale_bar(const Scene& scene);
  void draw_color_bar(const Scene& scene);
  void draw_badges(const Scene& scene);
  void draw_help(const std::vector<HelpLine>& help);
  void draw_timeline(const Scene& scene);

  Canvas canvas_;
  std::optional<Status> drawn_;  ///< what the panel shows now
};

}  // namespace screed::viewer
