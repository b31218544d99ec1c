// An RGB picture in memory with anti-aliased drawing, on top of cairo. Knows pixels and colours,
// no terrain. The same calls give the same bytes on the same machine (fonts come from the system).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host_sim/render/picture/color_map.h"

namespace screed {

/// A place in pixels from the top left corner, y downwards.
struct Pixel {
  double x;
  double y;
};

/// A rectangle in pixels.
struct PixelBox {
  double left;
  double top;
  double width;
  double height;
};

enum class TextAlign { kLeft, kCenter, kRight };

struct TextStyle {
  double size_px = 15.0;
  Color color{0.13, 0.15, 0.17};
  TextAlign align = TextAlign::kLeft;
  bool bold = false;
  bool upwards = false;  ///< turned to read from bottom to top
};

class Canvas {
 public:
  /// A canvas filled with `background`. Throws RunError when memory is short.
  Canvas(int width_px, int height_px, Color background);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }

  /// Joined lines with round corners and ends.
  void line(std::span<const Pixel> points, double width_px, Color color);
  void polygon(std::span<const Pixel> corners, Color fill);
  void polygon_outline(std::span<const Pixel> corners, double width_px, Color color);
  void circle(Pixel center, double radius_px, Color fill);
  void rectangle(const PixelBox& box, Color fill);
  void rectangle_outline(const PixelBox& box, double width_px, Color color);

  /// UTF-8 text in the system's sans-serif font; `anchor` is on the base line.
  void text(Pixel anchor, const std::string& words, const TextStyle& style);
  [[nodiscard]] double text_width(const std::string& words, const TextStyle& style);

  /// Sets opaque pixels, 0x00RRGGBB, from (x, y) to the right; all must be on the canvas.
  void set_row(int x, int y, std::span<const uint32_t> colors);

  /// For code that draws pixel by pixel: 0x00RRGGBB, row by row from the top, width() a row; good
  /// until the next call of anything else. release_pixels() when done with them.
  [[nodiscard]] std::span<uint32_t> pixels();
  void release_pixels();

  /// Drawing outside the box is cut off until the next call of unclip().
  void clip(const PixelBox& box);
  void unclip();

  /// The picture as width * height * 3 bytes, top row first. Throws RunError when any drawing
  /// failed, for instance because the system has no font.
  [[nodiscard]] std::vector<uint8_t> rgb() const;

  /// Writes a PNG; RunError as write_rgb_png() and rgb().
  void write_png(const std::filesystem::path& path) const;

 private:
  struct Cairo;
  struct CairoDeleter {
    void operator()(Cairo* cairo) const;
  };
  int width_;
  int height_;
  std::unique_ptr<Cairo, CairoDeleter> cairo_;
};

}  // namespace screed
