// The ground from above, pixel by pixel: heights in colour under light with contour lines, and what
// has changed between two grounds. Knows places in metres and colours, no canvas.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/render/picture/color_map.h"
#include "host_sim/render/picture/map_frame.h"

namespace screed {

/// dz/dx and dz/dy, rise over run.
struct Relief {
  double x;
  double y;
};

/// Lambert's law for light from the north-west, 45 degrees high; 1 = as bright as level ground.
inline double light(const Relief& slope, double exaggeration) {
  const double gx = slope.x * exaggeration;
  const double gy = slope.y * exaggeration;
  constexpr double kHalfRoot = 0.70710678118654752440;
  // Towards the light: (-1/2, 1/2, 1/sqrt 2); the surface's normal: (-gx, -gy, 1).
  const double toward = 0.5 * gx - 0.5 * gy + kHalfRoot;
  const double facing = toward / std::sqrt(gx * gx + gy * gy + 1.0);
  return std::max(0.0, facing) / kHalfRoot;
}

/// The middles of a map's pixels: x of its columns from the west, y of its rows from the north.
struct PixelGrid {
  std::vector<double> x_m;
  std::vector<double> y_m;
  double metres_per_pixel = 0.0;
  bool operator==(const PixelGrid&) const = default;
};

/// The colours and contour lines of a height map.
struct HeightColors {
  double low_m;
  double high_m;
  Ticks contours;

  [[nodiscard]] double share(double height_m) const {
    return (height_m - low_m) / (high_m - low_m);
  }
  [[nodiscard]] Color color(double height_m) const { return height_color(share(height_m)); }
  bool operator==(const HeightColors& other) const {
    return low_m == other.low_m && high_m == other.high_m && contours.step == other.contours.step;
  }
};

/// A colour ramp under light: pixel_of(lit(ramp(t), light)) for a tenth of its instructions, since
/// that takes six powers. Colours come from a table, with straight lines between its entries; where
/// the last bit of a pixel depends on the difference, from the ramp itself.
class LitRamp {
 public:
  using Ramp = Color (*)(double t);

  /// Of t from low to high; beyond, the ramp's ends go on.
  LitRamp(Ramp ramp, double low, double high);

  /// Each component times `light`, which is 0..1.5.
  [[nodiscard]] uint32_t pixel(double t, double light) const;
  static Color lit(Color color, double light);

 private:
  Ramp ramp_;
  double low_;
  double per_t_;
  std::vector<Color> table_;
};

/// Paints height maps one after the other. Where one has the grid and the scale of the one before,
/// only those pixels are computed whose ground is another.
class HeightPainter {
 public:
  /// 0x00RRGGBB, row by row from the north, until the next call.
  std::span<const uint32_t> paint(const HeightField& field, const PixelGrid& grid,
                                  const HeightColors& scale);

 private:
  /// What the pixels show.
  struct Painted {
    HeightField field;
    PixelGrid grid;
    HeightColors scale;
  };

  LitRamp ramp_{height_color, 0.0, 1.0};
  std::optional<Painted> painted_;
  std::vector<uint32_t> pixels_;
};

/// after - before in diverging colours, strongest at largest_m up and down, over a faint relief of
/// `after`. The same pixels.
std::vector<uint32_t> paint_difference(const PixelGrid& grid, const HeightField& before,
                                       const HeightField& after, double largest_m);

}  // namespace screed
