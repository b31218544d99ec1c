// Pixel by pixel.
#include "tools/screed/viewer/pixel_drawing.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace screed::viewer {
namespace {

constexpr uint32_t kRedBlue = 0x00FF00FF;
constexpr uint32_t kGreen = 0x0000FF00;

/// From a to b by part / 256.
uint32_t mixed(uint32_t a, uint32_t b, uint32_t part) {
  const uint32_t red_blue = ((a & kRedBlue) * (256U - part) + (b & kRedBlue) * part) >> 8U;
  const uint32_t green = ((a & kGreen) * (256U - part) + (b & kGreen) * part) >> 8U;
  return (red_blue & kRedBlue) | (green & kGreen);
}

uint32_t darker(uint32_t color) {
  return ((color & 0x00FEFEFEU) >> 1U) + ((color & 0x00F8F8F8U) >> 3U);
}

/// Where a row or column of pixels lies between nodes.
struct Between {
  int low;
  int high;
  uint32_t part;  ///< of 256, towards high
  bool bed;       ///< on the bed itself, not beyond it or on one of its copies
  bool ground;    ///< there is something to be seen
};

Between between(double node, int nodes, bool wrap) {
  const double last = wrap ? nodes : nodes - 1;
  const bool bed = node >= 0.0 && node <= last;
  if (!bed && !wrap) return {0, 0, 0, false, false};
  const double within = wrap ? node - std::floor(node / nodes) * nodes : node;
  int low = std::min(static_cast<int>(within), nodes - 1);
  const auto part = static_cast<uint32_t>((within - low) * 256.0);
  if (!wrap && low == nodes - 1) return {low, low, 0, bed, true};
  const int high = low + 1 == nodes ? 0 : low + 1;
  return {low, high, std::min(part, 255U), bed, true};
}

}  // namespace

uint32_t packed(Color color) {
  const auto channel = [](double value) {
    return static_cast<uint32_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255.0));
  };
  return channel(color.red) << 16U | channel(color.green) << 8U | channel(color.blue);
}

void draw_terrain(const PixelBuffer& buffer, const Camera& camera, const TerrainImage& image,
                  const TerrainPlacement& place, uint32_t beyond) {
  const PixelBox& box = camera.box();
  const int left = static_cast<int>(box.left);
  const int top = static_cast<int>(box.top);
  const auto width = static_cast<size_t>(box.width);
  const auto nodes_x = static_cast<size_t>(image.width());
  std::vector<Between> columns(width);
  for (size_t i = 0; i < width; ++i) {
    const double x = camera.x_at(left + static_cast<double>(i) + 0.5);
    columns[i] = between((x - place.x_min_m) / place.spacing_m, image.width(), place.wrap);
  }
  const uint32_t* nodes = image.pixels().data();
  for (int y = top; y < top + static_cast<int>(box.height); ++y) {
    uint32_t* target = buffer.pixels.data() +
                       static_cast<size_t>(y) * static_cast<size_t>(buffer.width) +
                       static_cast<size_t>(left);
    const Between row = between((camera.y_at(y + 0.5) - place.y_min_m) / place.spacing_m,
                                image.height(), place.wrap);
    if (!row.ground) {
      std::fill_n(target, width, beyond);
      continue;
    }
    const uint32_t* south = nodes + static_cast<size_t>(row.low) * nodes_x;
    const uint32_t* north = nodes + static_cast<size_t>(row.high) * nodes_x;
    for (const Between& column : columns) {
      if (!column.ground) {
        *target++ = beyond;
        continue;
      }
      const uint32_t below = mixed(south[column.low], south[column.high], column.part);
      const uint32_t above = mixed(north[column.low], north[column.high], column.part);
      const uint32_t color = mixed(below, above, row.part);
      *target++ = row.bed && column.bed ? color : darker(color);
    }
  }
}

void draw_stroke(const PixelBuffer& buffer, const PixelBox& box, Pixel from, Pixel to,
                 double width_px, uint32_t color) {
  const double reach = 0.5 * width_px + 1.0;
  const auto low = [&](double a, double b, double edge) {
    return static_cast<int>(std::max(std::floor(std::min(a, b) - reach), edge));
  };
  const auto high = [&](double a, double b, double edge) {
    return static_cast<int>(std::min(std::ceil(std::max(a, b) + reach), edge));
  };
  const int left = low(from.x, to.x, box.left);
  const int right = high(from.x, to.x, box.left + box.width);
  const int top = low(from.y, to.y, box.top);
  const int bottom = high(from.y, to.y, box.top + box.height);
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  const double length_squared = dx * dx + dy * dy;
  const double scale = length_squared > 0.0 ? 1.0 / length_squared : 0.0;
  for (int y = top; y < bottom; ++y) {
    uint32_t* row =
        buffer.pixels.data() + static_cast<size_t>(y) * static_cast<size_t>(buffer.width);
    const double py = y + 0.5 - from.y;
    for (int x = left; x < right; ++x) {
      const double px = x + 0.5 - from.x;
      const double along = std::clamp((px * dx + py * dy) * scale, 0.0, 1.0);
      const double across = std::hypot(px - along * dx, py - along * dy);
      const double cover = std::clamp(0.5 * width_px + 0.5 - across, 0.0, 1.0);
      if (cover <= 0.0) continue;
      row[x] = mixed(row[x], color, static_cast<uint32_t>(cover * 256.0));
    }
  }
}

}  // namespace screed::viewer
