// A map has more pixels than the ground has nodes: what a row or a column has in common is worked
// out once.
#include "host_sim/render/picture/ground_painter.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace screed {

namespace {

// Entries of a ramp's table but the last; anchors of the ramps are entries. Lines between them are
// off by less than kTableError, in steps of a pixel's component.
constexpr size_t kTableSteps = 1280;
constexpr double kTableError = 5e-4;
constexpr double kMaxLight = 1.5;

/// Where the pixels of a row or column see the ground: in their middle, and a node's distance to
/// both sides of it for the slope, which would jump from cell to cell at a place alone.
struct PixelPlace {
  HeightField::AxisPosition before;
  HeightField::AxisPosition middle;
  HeightField::AxisPosition behind;
  double reach_m;     ///< from before to behind
  size_t first_node;  ///< of all that count
  size_t last_node;
};

std::vector<PixelPlace> places(const std::vector<double>& middles, const HeightField& field,
                               double low_edge, double high_edge,
                               HeightField::AxisPosition (HeightField::*along)(double) const) {
  const double node_m = field.spacing_m();
  std::vector<PixelPlace> places;
  places.reserve(middles.size());
  for (const double middle : middles) {
    const double before = field.wrap() ? middle - node_m : std::max(middle - node_m, low_edge);
    const double behind = field.wrap() ? middle + node_m : std::min(middle + node_m, high_edge);
    PixelPlace place{(field.*along)(before),
                     (field.*along)(middle),
                     (field.*along)(behind),
                     behind - before,
                     0,
                     0};
    std::tie(place.first_node, place.last_node) =
        std::minmax({place.before.low, place.before.high, place.middle.low, place.middle.high,
                     place.behind.low, place.behind.high});
    places.push_back(place);
  }
  return places;
}

std::vector<PixelPlace> columns_of(const PixelGrid& grid, const HeightField& field) {
  return places(grid.x_m, field, field.x_min(), field.x_max(), &HeightField::along_x);
}

std::vector<PixelPlace> rows_of(const PixelGrid& grid, const HeightField& field) {
  return places(grid.y_m, field, field.y_min(), field.y_max(), &HeightField::along_y);
}

Relief slope_at(const HeightField& field, const PixelPlace& x, const PixelPlace& y) {
  return {(field.at(x.behind, y.middle).height - field.at(x.before, y.middle).height) / x.reach_m,
          (field.at(x.middle, y.behind).height - field.at(x.middle, y.before).height) / y.reach_m};
}

/// As much of the light as a surface takes whose relief is to be seen so strongly, 0..1.
double shade(double brightness, double strength) {
  return 1.0 + strength * (brightness - 1.0);
}

/// How much of a pixel a contour line covers, 0..1, for lines at multiples of `interval`.
double contour_cover(double height, const Relief& slope, double interval, double metres_per_pixel) {
  constexpr double kHalfWidth_px = 0.5;
  const double rise_per_pixel = std::hypot(slope.x, slope.y) * metres_per_pixel;
  if (rise_per_pixel < 1e-4 * interval) return 0.0;  // level ground is no line
  const double distance_px =
      std::abs(height - std::round(height / interval) * interval) / rise_per_pixel;
  return std::clamp(kHalfWidth_px + 0.5 - distance_px, 0.0, 1.0);
}

/// Columns of nodes, at first none.
struct NodeRange {
  size_t first = SIZE_MAX;
  size_t last = 0;

  void add(const NodeRange& other) {
    first = std::min(first, other.first);
    last = std::max(last, other.last);
  }
  bool touches(const PixelPlace& place) const {
    return place.first_node <= last && place.last_node >= first;
  }
};

/// In each row of nodes, from the first to the last that differs.
std::vector<NodeRange> differences(const HeightField& one, const HeightField& other) {
  const auto nodes = static_cast<size_t>(one.nx());
  std::vector<NodeRange> rows(static_cast<size_t>(one.ny()));
  for (size_t row = 0; row < rows.size(); ++row) {
    const Height* const a = one.heights() + row * nodes;
    const Height* const b = other.heights() + row * nodes;
    const Height* const first = std::mismatch(a, a + nodes, b).first;
    if (first == a + nodes) continue;
    size_t last = nodes - 1;
    while (a[last] == b[last]) --last;
    rows[row] = {static_cast<size_t>(first - a), last};
  }
  return rows;
}

/// The ground at a place, with light and contour lines.
uint32_t height_pixel(const HeightField& field, const PixelPlace& x, const PixelPlace& y,
                      const HeightColors& scale, const PixelGrid& grid, const LitRamp& ramp) {
  constexpr double kExaggeration = 1.6;
  constexpr double kShadeStrength = 0.75;
  constexpr double kContourStrength = 0.22;
  const double height = field.at(x.middle, y.middle).height;
  const Relief slope = slope_at(field, x, y);
  const double ink =
      kContourStrength * contour_cover(height, slope, scale.contours.step, grid.metres_per_pixel);
  return ramp.pixel(scale.share(height),
                    shade(light(slope, kExaggeration) * (1.0 - ink), kShadeStrength));
}

bool same_grid(const HeightField& one, const HeightField& other) {
  return one.nx() == other.nx() && one.ny() == other.ny() && one.wrap() == other.wrap() &&
         one.spacing_m() == other.spacing_m();
}

}  // namespace

// ---- colours -----------------------------------------------------------------------------------

LitRamp::LitRamp(Ramp ramp, double low, double high)
    : ramp_(ramp), low_(low), per_t_(static_cast<double>(kTableSteps) / (high - low)) {
  table_.reserve(kTableSteps + 1);
  for (size_t i = 0; i <= kTableSteps; ++i)
    table_.push_back(ramp(low + static_cast<double>(i) / per_t_));
}

Color LitRamp::lit(Color color, double light) {
  return {color.red * light, color.green * light, color.blue * light};
}

uint32_t LitRamp::pixel(double t, double light) const {
  constexpr double kFull = 255.0;
  const double place = std::clamp((t - low_) * per_t_, 0.0, double{kTableSteps});
  const size_t entry = std::min(static_cast<size_t>(place), kTableSteps - 1);
  const double part = place - static_cast<double>(entry);
  const Color& from = table_[entry];
  const Color& to = table_[entry + 1];
  const auto component = [&](double a, double b) {
    return std::min((a + part * (b - a)) * light * kFull, kFull) + 0.5;
  };
  const double red = component(from.red, to.red);
  const double green = component(from.green, to.green);
  const double blue = component(from.blue, to.blue);
  const auto red_byte = static_cast<uint32_t>(red);
  const auto green_byte = static_cast<uint32_t>(green);
  const auto blue_byte = static_cast<uint32_t>(blue);
  // From the middle between two steps, where rounding has no doubt.
  const double off = std::max({std::abs(red - red_byte - 0.5), std::abs(green - green_byte - 0.5),
                               std::abs(blue - blue_byte - 0.5)});
  if (off > 0.5 - kMaxLight * kTableError) return pixel_of(lit(ramp_(t), light));
  return (red_byte << 16) | (green_byte << 8) | blue_byte;
}

// ---- maps --------------------------------------------------------------------------------------

std::span<const uint32_t> HeightPainter::paint(const HeightField& field, const PixelGrid& grid,
                                               const HeightColors& scale) {
  const std::vector<PixelPlace> columns = columns_of(grid, field);
  const std::vector<PixelPlace> rows = rows_of(grid, field);
  const bool same_map = painted_ && painted_->grid == grid && painted_->scale == scale &&
                        same_grid(painted_->field, field);
  const std::vector<NodeRange> differing =
      same_map ? differences(painted_->field, field)
               : std::vector<NodeRange>(static_cast<size_t>(field.ny()),
                                        {0, static_cast<size_t>(field.nx()) - 1});
  pixels_.resize(columns.size() * rows.size());
  uint32_t* target = pixels_.data();
  for (const PixelPlace& y : rows) {
    NodeRange nodes;
    for (size_t row = y.first_node; row <= y.last_node; ++row) nodes.add(differing[row]);
    for (const PixelPlace& x : columns) {
      if (nodes.touches(x)) *target = height_pixel(field, x, y, scale, grid, ramp_);
      ++target;
    }
  }
  painted_ = {field, grid, scale};
  return pixels_;
}

std::vector<uint32_t> paint_difference(const PixelGrid& grid, const HeightField& before,
                                       const HeightField& after, double largest_m) {
  constexpr double kExaggeration = 1.2;
  constexpr double kShadeStrength = 0.3;
  const LitRamp ramp(difference_color, -1.0, 1.0);
  const std::vector<PixelPlace> columns = columns_of(grid, after);
  std::vector<uint32_t> pixels;
  pixels.reserve(grid.x_m.size() * grid.y_m.size());
  for (const PixelPlace& y : rows_of(grid, after)) {
    for (const PixelPlace& x : columns) {
      const double rise =
          after.at(x.middle, y.middle).height - before.at(x.middle, y.middle).height;
      pixels.push_back(ramp.pixel(
          rise / largest_m, shade(light(slope_at(after, x, y), kExaggeration), kShadeStrength)));
    }
  }
  return pixels;
}

}  // namespace screed
