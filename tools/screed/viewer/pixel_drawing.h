// The two things of a frame that are too many for a drawing library: every pixel of the ground, and
// the pieces of a long path.
#pragma once

#include <cstdint>
#include <span>

#include "host_sim/render/picture/canvas.h"
#include "tools/screed/viewer/camera.h"
#include "tools/screed/viewer/terrain_image.h"

namespace screed::viewer {

/// 0x00RRGGBB, row by row from the top.
struct PixelBuffer {
  std::span<uint32_t> pixels;
  int width;
};

uint32_t packed(Color color);

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
