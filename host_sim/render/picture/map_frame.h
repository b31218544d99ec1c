// The furniture around a map: title, axes in metres, colour bar, scale bar, and where the map's
// pixels lie. Knows a rectangle of ground and a range of values, not what they mean.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "host_sim/render/picture/canvas.h"

namespace screed {

/// Round numbers (1, 2 or 5 times a power of ten apart) from low to high inclusive, at most
/// `max_count` (at least 2); empty unless low < high.
struct Ticks {
  double step = 0.0;
  int decimals = 0;  ///< digits after the point that tell neighbours apart
  std::vector<double> values;
};
Ticks round_ticks(double low, double high, int max_count);

/// A number with a fixed count of decimals and a real minus sign; never "-0".
std::string number_text(double value, int decimals);

/// A rectangle of ground in metres, x east and y north.
struct MapRectangle {
  double x_min;
  double x_max;
  double y_min;
  double y_max;
};

/// What the colour bar shows: colour over values from low to high.
struct ColorScale {
  double low;
  double high;
  std::string label;
  std::function<Color(double value)> color;
};

class MapFrame {
 public:
  /// Lays out a map of `ground` on the canvas, as large as fits and true to scale, with room for a
  /// legend under the colour bar.
  MapFrame(Canvas& canvas, const MapRectangle& ground, double legend_height_px);

  [[nodiscard]] const PixelBox& map() const { return map_; }  ///< on whole pixels
  /// Left end of the legend's first base line.
  [[nodiscard]] Pixel legend() const { return legend_; }
  [[nodiscard]] double pixels_per_metre() const { return pixels_per_metre_; }
  [[nodiscard]] Pixel to_pixel(double x_m, double y_m) const;
  [[nodiscard]] double x_at(double pixel_x) const;
  [[nodiscard]] double y_at(double pixel_y) const;

  /// Both lines are set smaller when they would not fit the canvas.
  void draw_title(const std::string& title, const std::string& subtitle);
  /// Boards round the map: the walls of the ground. Before the axes.
  void draw_walls();
  void draw_axes();
  void draw_color_bar(const ColorScale& scale);
  void draw_scale_bar();

 private:
  void draw_fitted(Pixel anchor, const std::string& words, TextStyle style);

  Canvas& canvas_;
  MapRectangle ground_;
  double pixels_per_metre_;
  PixelBox map_;
  PixelBox bar_;
  Pixel legend_;
};

/// The ground from above without the furniture around it, for pictures that put several together:
/// width x height pixels, its rows from the north.
struct MapImage {
  MapRectangle ground;
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

}  // namespace screed
