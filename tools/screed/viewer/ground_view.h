// The ground as it is seen: its image, a pixel a node, of which only what changed is painted again;
// the camera; and the two things of a frame that are too many for a drawing library: every pixel of
// the ground, and the pieces of a long path.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/map_frame.h"
#include "host_sim/run/session/session_layout.h"

namespace screed::viewer {

/// What the colours say. Light and shade of the relief are on all of them.
enum class Shading : uint8_t { kHeight, kSlope, kChange };
inline constexpr size_t kShadings = 3;

/// What is beside the colours of a shading.
struct ShadingScale {
  std::string label;
  std::string unit;
  double low = 0.0;
  double high = 0.0;
};

class TerrainImage {
 public:
  /// With the ground as it is; changes count from `before`, of the same grid, which also gives the
  /// scale of heights.
  TerrainImage(const HeightField& field, const HeightField& before);

  /// These heights of the field have changed.
  void update(const HeightField& field, std::span<const HeightChange> changes);
  /// Paints what is not up to date. Returns the number of pixels painted.
  size_t paint(const HeightField& field, Shading shading);

  /// 0x00RRGGBB, row by row from the south, a pixel a node, as paint() left them.
  const std::vector<uint32_t>& pixels() const { return pixels_; }
  int width() const { return nx_; }
  int height() const { return ny_; }
  ShadingScale scale(Shading shading) const;
  /// The colour of a value on level ground; `share` 0..1 from the scale's low to its high end.
  static Color color(Shading shading, double share);

 private:
  static constexpr size_t kColors = 1024;

  uint32_t pixel_at(const HeightField& field, int ix, int iy, Shading shading) const;
  /// Whether the scale of changes had to grow for this height.
  bool grow_scale(const HeightField& field, size_t node);
  void mark(int ix, int iy);

  int nx_;
  int ny_;
  bool wrap_;
  double low_m_;
  double high_m_;
  double change_m_;  // at the ends of the scale
  double exaggeration_;
  std::vector<Height> before_;
  std::vector<uint32_t> pixels_;
  std::vector<uint32_t> waiting_;  // nodes to be painted
  std::vector<uint8_t> waits_;     // of each node
  bool all_waits_ = true;
  Shading shading_ = Shading::kHeight;
  std::array<std::array<Color, kColors>, kShadings> colors_;
};

/// Where the eye is: which part of the ground lies on which part of the window.
class Camera {
 public:
  static constexpr double kMinScale = 5.0;      ///< pixels a metre
  static constexpr double kMaxScale = 20000.0;  ///< a millimetre is 20 pixels

  /// The part of the window that shows the ground; its middle goes on showing the same place.
  void set_box(const PixelBox& box) { box_ = box; }
  const PixelBox& box() const { return box_; }

  /// Shows all of `ground`, with a small margin.
  void fit(const MapRectangle& ground);
  /// Looks at a place.
  void look_at(double x_m, double y_m) {
    x_ = x_m;
    y_ = y_m;
  }
  /// Zooms by `factor`; what lies under `fixed` stays there.
  void zoom(double factor, Pixel fixed);
  /// The ground follows a drag.
  void drag(double dx_px, double dy_px) {
    x_ -= dx_px / scale_;
    y_ += dy_px / scale_;
  }

  double scale() const { return scale_; }  ///< pixels a metre
  Pixel middle() const { return {box_.left + 0.5 * box_.width, box_.top + 0.5 * box_.height}; }
  Pixel to_pixel(double x_m, double y_m) const {
    return {middle().x + (x_m - x_) * scale_, middle().y - (y_m - y_) * scale_};
  }
  double x_at(double pixel_x) const { return x_ + (pixel_x - middle().x) / scale_; }
  double y_at(double pixel_y) const { return y_ - (pixel_y - middle().y) / scale_; }

 private:
  PixelBox box_{0.0, 0.0, 1.0, 1.0};
  double x_ = 0.0;
  double y_ = 0.0;
  double scale_ = 100.0;
};

/// 0x00RRGGBB, row by row from the top.
struct PixelBuffer {
  std::span<uint32_t> pixels;
  int width;
};

/// How a ground image lies in the world.
struct TerrainPlacement {
  double x_min_m;
  double y_min_m;
  double spacing_m;
  bool wrap;
  bool walls = false;  ///< along the edges of the bed
};

/// Fills the camera's box with the ground, bilinear between nodes. Beyond the edges of the bed:
/// `beyond`; with wrap its copies, darker.
void draw_terrain(const PixelBuffer& buffer, const Camera& camera, const TerrainImage& image,
                  const TerrainPlacement& place, uint32_t beyond);

/// A line with round ends, cut off at the box.
void draw_stroke(const PixelBuffer& buffer, const PixelBox& box, Pixel from, Pixel to,
                 double width_px, uint32_t color);

}  // namespace screed::viewer
