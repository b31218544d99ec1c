// A surface z = f(x, y): integer heights on a square grid, bilinear in between.
// Knows neither robots nor soil. The integers are the truth (so volumes add up exactly and bits are
// equal on every compiler); metres are derived from them.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "host_sim/physics/terrain/grey_image.h"

namespace screed {

/// A height in units of kHeightUnit_m (about 60 nm); the range is +-128 m.
using Height = int32_t;
inline constexpr double kHeightUnit_m = 0x1p-24;  // a power of two: to metres without rounding

/// What is beyond the edges of a bed.
enum class BedEdge : uint8_t {
  kOpen,     ///< the terrain ends; its edge heights go on, level across the edge
  kWrapped,  ///< the same bed again: what leaves on one side comes back on the other
  kWalled,   ///< vertical walls without a top, which hold the terrain's material and robots
};

/// The surface at one place: height in metres, gradient dz/dx and dz/dy (rise over run).
struct SurfacePoint {
  double height;
  double gradient_x;
  double gradient_y;
};

/// The heights at the corners of one grid cell.
struct CellHeights {
  Height south_west;
  Height south_east;
  Height north_west;
  Height north_east;
};

/// How an image becomes terrain.
struct HeightFieldOptions {
  double size_m = 3.0;   ///< length of the bed's longer side, 0.1..1000
  double scale_m = 0.2;  ///< of images: height of full white, 0.0001..100; black is 0
  /// Standard deviation of a Gaussian low-pass over the image before anything else, metres on the
  /// bed; 0..1; 0: none. An elevation model at robot scale has cliffs of one pixel; without them
  /// more relief fits under a slope limit.
  double smoothing_m = 0.0;
  /// When the steepest slope exceeds this, all heights are scaled down until it is met: 0.1..89.
  std::optional<double> max_slope_deg = std::nullopt;
  bool wrap = false;  ///< the image tiles: its right edge continues at its left, top at bottom
};

/// nx x ny heights. Node (0, 0) is the south-west corner, x grows east with ix and y north with iy;
/// the bed's centre is (0, 0) of the world. Without wrap the bed has (nx - 1) x (ny - 1) cells and
/// its edge heights continue outwards, level across the edge. With wrap it has nx x ny cells and
/// repeats for ever.
class HeightField {
 public:
  /// A level field at height 0. Throws InputError unless 2 <= nx, ny <= 16384 and the spacing is
  /// 1e-6..100 m.
  HeightField(int nx, int ny, double spacing_m, bool wrap);

  /// Image samples become nodes; row 0 is the north edge. Throws InputError, naming the option and
  /// its range, for options out of range and for images of less than 2 x 2 samples.
  /// With max_slope_deg the steepest slope is at most the limit and, if it was above, short of it
  /// by no more than the rounding of heights: about 2 kHeightUnit_m a grid spacing.
  static HeightField from_image(const GreyImage& image, const HeightFieldOptions& options);

  /// The same from heights in metres above whatever: width * height, row 0 is the north edge. The
  /// lowest becomes 0. Throws InputError as from_image(), and when the highest is more than 127 m
  /// above it.
  static HeightField from_heights(int width, int height, const std::vector<double>& heights_m,
                                  const HeightFieldOptions& options);

  /// Heights in metres from f(x, y) at the nodes, rounded to the unit. Throws InputError as the
  /// constructor, or when a height is not finite or not within +-127 m.
  static HeightField from_function(int nx, int ny, double spacing_m, bool wrap,
                                   const std::function<double(double x, double y)>& height_m);

  /// A level square bed at height 0; the spacing is adjusted to divide the size. Throws InputError
  /// unless size_m is 0.1..1000 and spacing_m at most half of it.
  static HeightField flat(double size_m, double spacing_m, bool wrap = false);

  /// As flat(), but rising to the east: z = x tan(slope), slope -89..89 degrees.
  static HeightField ramp(double size_m, double spacing_m, double slope_deg);

  [[nodiscard]] int nx() const { return x_axis_.nodes; }
  [[nodiscard]] int ny() const { return y_axis_.nodes; }
  [[nodiscard]] int cells_x() const { return cells_along(nx()); }
  [[nodiscard]] int cells_y() const { return cells_along(ny()); }
  [[nodiscard]] double spacing_m() const { return spacing_m_; }
  [[nodiscard]] bool wrap() const { return wrap_; }
  /// Puts walls along the edges of a bed without wrap; its heights stay. One with wrap has none.
  void add_walls() { walled_ = !wrap_; }
  [[nodiscard]] BedEdge edge() const {
    if (wrap_) return BedEdge::kWrapped;
    return walled_ ? BedEdge::kWalled : BedEdge::kOpen;
  }

  /// The bed's edges and the nodes' places, metres. With wrap x_max is x_min one bed further.
  [[nodiscard]] double x_min() const { return x_axis_.begin_m; }
  [[nodiscard]] double y_min() const { return y_axis_.begin_m; }
  [[nodiscard]] double x_max() const { return -x_axis_.begin_m; }
  [[nodiscard]] double y_max() const { return -y_axis_.begin_m; }
  [[nodiscard]] double node_x(int ix) const { return x_axis_.begin_m + ix * spacing_m_; }
  [[nodiscard]] double node_y(int iy) const { return y_axis_.begin_m + iy * spacing_m_; }

  /// 0 <= ix < nx, 0 <= iy < ny: not checked.
  [[nodiscard]] Height node(int ix, int iy) const { return heights_[index(ix, iy)]; }
  /// All of them, row by row from the south: iy nx + ix.
  [[nodiscard]] const Height* heights() const { return heights_.data(); }
  /// The same by place in the row-by-row order: iy nx + ix, not checked.
  [[nodiscard]] Height node(size_t index) const { return heights_[index]; }
  void set_node(int ix, int iy, Height height) {
    heights_[index(ix, iy)] = height;
    // Divided as unsigned numbers, so by shifts.
    const size_t tile = static_cast<unsigned>(iy) / kTileNodes * static_cast<size_t>(tiles_x_) +
                        static_cast<unsigned>(ix) / kTileNodes;
    ++tile_revisions_[tile];
    Height& highest = tile_highest_[tile];
    if (height > highest) highest = height;
  }

  /// For code that follows the changes of a field: the bed in tiles of kTileNodes x kTileNodes
  /// nodes (those at the east and north edge are cut off), row by row from the south, and how often
  /// a node of each was set (modulo 2^32).
  static constexpr int kTileNodes = 16;
  [[nodiscard]] int tiles_x() const { return tiles_x_; }
  [[nodiscard]] const std::vector<uint32_t>& tile_revisions() const { return tile_revisions_; }

  /// 0 <= ix < cells_x, 0 <= iy < cells_y: not checked.
  [[nodiscard]] CellHeights cell(int ix, int iy) const {
    const int east = ix + 1 == nx() ? 0 : ix + 1;  // 0 only with wrap
    const int north = iy + 1 == ny() ? 0 : iy + 1;
    return {node(ix, iy), node(east, iy), node(ix, north), node(east, north)};
  }

  /// The bilinear surface at any place; the hot path. Outside a field without wrap (on its very
  /// edge too, when the coordinate rounds outwards) the gradient across the edge is 0. Coordinates
  /// that are no numbers, or with wrap more than 1e9 beds away, are read as the south-west
  /// corner's.
  [[nodiscard]] SurfacePoint at(double x, double y) const { return at(along_x(x), along_y(y)); }

  /// A place along one axis: between nodes `low` and `high`, `fraction` of the way.
  struct AxisPosition {
    size_t low;
    size_t high;
    double fraction;
    double gradient_scale;  // units a node to rise over run; 0 outside
  };
  /// at() in two steps, for code that looks at many places of a row or a column: the same bits.
  [[nodiscard]] AxisPosition along_x(double x) const { return locate(x, x_axis_); }
  [[nodiscard]] AxisPosition along_y(double y) const { return locate(y, y_axis_); }
  [[nodiscard]] SurfacePoint at(const AxisPosition& u, const AxisPosition& v) const;

  /// Whether (x, y) is on the bed (with wrap: on its central copy).
  [[nodiscard]] bool inside(double x, double y) const {
    return x >= x_min() && x <= x_max() && y >= y_min() && y <= y_max();
  }

  /// A height in metres that the surface does not exceed within `radius` of (x, y): for a broad
  /// phase. Coarse, from maxima of tiles. Lowered nodes loosen it until refresh_bounds().
  [[nodiscard]] double max_height_within(double x, double y, double radius) const;
  void refresh_bounds();

  /// The steepest slope anywhere, as rise over run. Exact: within a cell dz/dx depends on y alone
  /// and dz/dy on x alone, both linearly, so the steepest point is a corner, where each takes the
  /// larger of its two edge values independently of the other.
  [[nodiscard]] double steepest_gradient() const;

  /// The sum of all node heights, in units. Times kHeightUnit_m and spacing_m^2 it is the volume
  /// above height 0 (with wrap exactly; without, every node counts as a full cell).
  [[nodiscard]] int64_t height_sum() const;

 private:
  static HeightField from_samples(int width, int height, std::vector<double> samples,
                                  double units_per_sample, const HeightFieldOptions& options);

  struct Axis {
    int nodes;
    double begin_m;        // the west or south edge
    double last;           // nodes - 1
    double beds_per_node;  // 1 / nodes
  };

  [[nodiscard]] int cells_along(int nodes) const { return wrap_ ? nodes : nodes - 1; }
  [[nodiscard]] size_t index(int ix, int iy) const {
    return static_cast<size_t>(iy) * static_cast<size_t>(x_axis_.nodes) + static_cast<size_t>(ix);
  }
  [[nodiscard]] size_t tile_index(int tx, int ty) const {
    return static_cast<size_t>(ty) * static_cast<size_t>(tiles_x_) + static_cast<size_t>(tx);
  }
  [[nodiscard]] AxisPosition locate(double coordinate, const Axis& axis) const {
    const double node = (coordinate - axis.begin_m) * nodes_per_m_;
    return wrap_ ? locate_wrapped(node, axis) : locate_clamped(node, axis);
  }
  [[nodiscard]] AxisPosition locate_clamped(double node, const Axis& axis) const;
  [[nodiscard]] AxisPosition locate_wrapped(double node, const Axis& axis) const;

  Axis x_axis_;
  Axis y_axis_;
  double spacing_m_;
  double nodes_per_m_;
  double gradient_scale_;  // kHeightUnit_m / spacing_m
  bool wrap_;
  bool walled_ = false;
  int tiles_x_;
  int tiles_y_;
  std::vector<Height> heights_;       // row by row from the south
  std::vector<Height> tile_highest_;  // an upper bound of each kTileNodes x kTileNodes nodes
  std::vector<uint32_t> tile_revisions_;
};

inline HeightField::AxisPosition HeightField::locate_clamped(double node, const Axis& axis) const {
  double clamped = node > 0.0 ? node : 0.0;  // also catches what is no number
  clamped = clamped < axis.last ? clamped : axis.last;
  int low = static_cast<int>(clamped);
  low = low < axis.nodes - 1 ? low : axis.nodes - 2;
  return {static_cast<size_t>(low), static_cast<size_t>(low) + 1, clamped - low,
          clamped == node ? gradient_scale_ : 0.0};
}

inline HeightField::AxisPosition HeightField::locate_wrapped(double node, const Axis& axis) const {
  constexpr double kMaxBeds = 1e9;
  const double beds = node * axis.beds_per_node;
  double within = 0.0;
  if (std::abs(beds) < kMaxBeds) {
    auto whole = static_cast<int64_t>(beds);
    whole -= beds < static_cast<double>(whole) ? 1 : 0;  // floor, without a call to the library
    within = node - static_cast<double>(whole) * axis.nodes;
    // Rounding can end just outside of [0, nodes); both ends are the same node.
    if (within < 0.0 || within >= axis.nodes) within = 0.0;
  }
  const int low = static_cast<int>(within);
  const int high = low + 1 == axis.nodes ? 0 : low + 1;
  return {static_cast<size_t>(low), static_cast<size_t>(high), within - low, gradient_scale_};
}

inline SurfacePoint HeightField::at(const AxisPosition& u, const AxisPosition& v) const {
  const Height* south = heights_.data() + v.low * static_cast<size_t>(x_axis_.nodes);
  const Height* north = heights_.data() + v.high * static_cast<size_t>(x_axis_.nodes);
  // In doubles a difference of heights cannot overflow and is exact.
  const double south_west = south[u.low];
  const double north_west = north[u.low];
  const double south_rise = south[u.high] - south_west;
  const double north_rise = north[u.high] - north_west;
  const double west_rise = north_west - south_west;
  const double twist = north_rise - south_rise;
  const double across_x = south_rise + v.fraction * twist;
  const double across_y = west_rise + u.fraction * twist;
  return {(south_west + v.fraction * west_rise + u.fraction * across_x) * kHeightUnit_m,
          across_x * u.gradient_scale, across_y * v.gradient_scale};
}

}  // namespace screed
