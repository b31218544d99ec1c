// Text of an SVG file, element by element, and the same as a PNG file. Knows shapes, words and
// colours, nothing of what they mean. The same calls give the same SVG bytes everywhere.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/render/picture/canvas.h"
#include "host_sim/render/picture/color_map.h"

namespace screed {

inline constexpr Color kChartInk{0.133, 0.149, 0.169};
inline constexpr Color kChartFaintInk{0.357, 0.388, 0.420};
inline constexpr Color kChartGrid{0.890, 0.902, 0.914};

/// Sizes that a chart may have.
inline constexpr int kMinChartWidth_px = 320;
inline constexpr int kMinChartHeight_px = 240;
inline constexpr int kMaxChartSide_px = 4000;

enum class SvgAnchor : std::uint8_t { kStart, kMiddle, kEnd };

struct SvgTextStyle {
  double size_px = 12.0;
  Color color = kChartInk;
  SvgAnchor anchor = SvgAnchor::kStart;
  bool bold = false;
  bool upwards = false;  ///< turned to read from bottom to top
};

/// Width of words in the pictures' font, on average: an SVG cannot measure.
double svg_text_width_px(const std::string& words, double size_px);

/// Words cut to a width, with an ellipsis where something is missing; empty when nothing fits.
std::string svg_fitted(const std::string& words, double size_px, double width_px);

class Svg {
 public:
  /// A white picture of that size.
  Svg(int width_px, int height_px);

  void line(Pixel from, Pixel to, Color color, double width_px);
  void polyline(const std::vector<Pixel>& points, Color color, double width_px = 2.0,
                bool dashed = false);
  void marker(Pixel at, double radius_px, Color color);  ///< with a white rim
  void small_dot(Pixel at, Color color);                 ///< half transparent
  void ring(Pixel at, double radius_px, Color color);    ///< white inside
  void rectangle(const PixelBox& box, Color fill, double round_px = 0.0);
  void frame(const PixelBox& box, Color color, double width_px);
  /// `at` is on the base line.
  void text(Pixel at, const std::string& words, const SvgTextStyle& style);
  /// A PNG file, stretched over the box.
  void image(const PixelBox& box, std::span<const std::uint8_t> png);
  /// Everything until end_clip() is cut off outside the box.
  void begin_clip(const PixelBox& box);
  void end_clip();

  /// The text of the file; nothing may be called afterwards.
  std::string finish();

 private:
  std::string out_;
  int clips_ = 0;
};

/// Draws an SVG into a PNG file at `scale` pixels for each of its own. Throws RunError when it
/// cannot be drawn or written.
void write_svg_as_png(const std::filesystem::path& path, const std::string& svg,
                      double scale = 2.0);

/// Throws InputError that begins with `option`, unless the name ends in .svg or .png.
void check_picture_name(const std::string& option, const std::filesystem::path& path);
/// Writes an SVG as its name says, as it is or as a PNG. Throws RunError.
void write_picture(const std::filesystem::path& path, const std::string& svg);

}  // namespace screed
