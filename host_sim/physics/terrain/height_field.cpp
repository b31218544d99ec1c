// Construction of height fields and everything off the hot path.
#include "host_sim/physics/terrain/height_field.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/physics/terrain/low_pass.h"

namespace screed {
namespace {

constexpr double kLargestHeight_m = 127.0;

struct Range {
  const char* name;
  double lowest;
  double highest;
};

constexpr Range kSize{"size_m", 0.1, 1000.0};
constexpr Range kScale{"scale_m", 0.0001, 100.0};
constexpr Range kSmoothing{"smoothing_m", 0.0, 1.0};
constexpr Range kMaxSlope{"max_slope_deg", 0.1, 89.0};
constexpr Range kSpacing{"spacing_m", 1e-6, 100.0};
constexpr Range kRampSlope{"slope_deg", -89.0, 89.0};

void require(const Range& range, double value) {
  if (value >= range.lowest && value <= range.highest) return;  // false for what is no number
  std::ostringstream message;
  message << "height field: " << range.name << " = " << value << "; allowed: " << range.lowest
          << " to " << range.highest;
  throw InputError(message.str());
}

void require_nodes(int nx, int ny) {
  if (std::min(nx, ny) >= 2 && std::max(nx, ny) <= kLargestImageSide) return;
  throw InputError("height field of " + std::to_string(nx) + " x " + std::to_string(ny) +
                   " samples; allowed: 2 to " + std::to_string(kLargestImageSide) + " a side");
}

double tan_deg(double angle_deg) {
  return portable::tan(angle_deg * std::numbers::pi / 180.0);
}

int nodes_along(double size_m, double spacing_m) {
  require(kSize, size_m);
  require({"spacing_m", size_m / (kLargestImageSide - 1), size_m / 2.0}, spacing_m);
  return static_cast<int>(std::lround(size_m / spacing_m)) + 1;
}

void fill_from_samples(HeightField& field, const std::vector<double>& samples,
                       double units_per_sample) {
  for (int iy = 0; iy < field.ny(); ++iy) {
    const size_t row = static_cast<size_t>(field.ny() - 1 - iy) * static_cast<size_t>(field.nx());
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double sample = samples[row + static_cast<size_t>(ix)];
      field.set_node(ix, iy, static_cast<Height>(std::lround(sample * units_per_sample)));
    }
  }
}

}  // namespace

HeightField::HeightField(int nx, int ny, double spacing_m, bool wrap)
    : spacing_m_(spacing_m), wrap_(wrap) {
  require_nodes(nx, ny);
  require(kSpacing, spacing_m);
  nodes_per_m_ = 1.0 / spacing_m;
  gradient_scale_ = kHeightUnit_m / spacing_m;
  x_axis_ = {nx, -0.5 * spacing_m * cells_along(nx), nx - 1.0, 1.0 / nx};
  y_axis_ = {ny, -0.5 * spacing_m * cells_along(ny), ny - 1.0, 1.0 / ny};
  tiles_x_ = (nx + kTileNodes - 1) / kTileNodes;
  tiles_y_ = (ny + kTileNodes - 1) / kTileNodes;
  heights_.assign(static_cast<size_t>(nx) * static_cast<size_t>(ny), 0);
  tile_highest_.assign(static_cast<size_t>(tiles_x_) * static_cast<size_t>(tiles_y_), 0);
  tile_revisions_.assign(tile_highest_.size(), 0);
}

HeightField HeightField::from_image(const GreyImage& image, const HeightFieldOptions& options) {
  require(kScale, options.scale_m);
  return from_samples(image.width, image.height, {image.samples.begin(), image.samples.end()},
                      options.scale_m / kHeightUnit_m / image.max_value, options);
}

HeightField HeightField::from_heights(int width, int height, const std::vector<double>& heights_m,
                                      const HeightFieldOptions& options) {
  require_nodes(width, height);
  const auto [lowest, highest] = std::minmax_element(heights_m.begin(), heights_m.end());
  require({"highest less lowest height", 0.0, kLargestHeight_m}, *highest - *lowest);
  std::vector<double> samples;
  samples.reserve(heights_m.size());
  for (const double height_m : heights_m) samples.push_back(height_m - *lowest);
  return from_samples(width, height, std::move(samples), 1.0 / kHeightUnit_m, options);
}

HeightField HeightField::from_samples(int width, int height, std::vector<double> samples,
                                      double units_per_sample, const HeightFieldOptions& options) {
  require(kSize, options.size_m);
  require(kSmoothing, options.smoothing_m);
  if (options.max_slope_deg) require(kMaxSlope, *options.max_slope_deg);
  require_nodes(width, height);

  const int longer = std::max(width, height);
  const double spacing_m = options.size_m / (options.wrap ? longer : longer - 1);
  HeightField field(width, height, spacing_m, options.wrap);
  if (options.smoothing_m > 0.0) {
    gaussian_filter(samples, width, height, options.smoothing_m / spacing_m,
                    options.wrap ? FilterEdge::kWrapped : FilterEdge::kRepeated);
  }
  fill_from_samples(field, samples, units_per_sample);

  if (options.max_slope_deg) {
    // Rounding to units can leave the slope a hair above the limit: then once more.
    const double limit = tan_deg(*options.max_slope_deg);
    constexpr double kHair = 1e-7;  // below one unit for heights up to 0.5 m
    double steepest = field.steepest_gradient();
    while (steepest > limit) {
      units_per_sample *= limit / steepest * (1.0 - kHair);
      fill_from_samples(field, samples, units_per_sample);
      steepest = field.steepest_gradient();
    }
  }
  field.refresh_bounds();
  return field;
}

HeightField HeightField::from_function(int nx, int ny, double spacing_m, bool wrap,
                                       const std::function<double(double x, double y)>& height_m) {
  HeightField field(nx, ny, spacing_m, wrap);
  for (int iy = 0; iy < ny; ++iy) {
    for (int ix = 0; ix < nx; ++ix) {
      const double height = height_m(field.node_x(ix), field.node_y(iy));
      require({"height_m", -kLargestHeight_m, kLargestHeight_m}, height);
      field.set_node(ix, iy, static_cast<Height>(std::lround(height / kHeightUnit_m)));
    }
  }
  field.refresh_bounds();
  return field;
}

HeightField HeightField::flat(double size_m, double spacing_m, bool wrap) {
  const int cells = nodes_along(size_m, spacing_m) - 1;
  const int nodes = wrap ? cells : cells + 1;
  return {nodes, nodes, size_m / cells, wrap};
}

HeightField HeightField::ramp(double size_m, double spacing_m, double slope_deg) {
  require(kRampSlope, slope_deg);
  const int nodes = nodes_along(size_m, spacing_m);
  const double rise = tan_deg(slope_deg);
  return from_function(nodes, nodes, size_m / (nodes - 1), false,
                       [rise](double x, double /*y*/) { return x * rise; });
}

double HeightField::max_height_within(double x, double y, double radius) const {
  // The nodes around the circle's bounding square, as at most two runs of tiles an axis.
  struct Run {
    int first;
    int last;
  };
  struct Runs {
    Run run[2];
    int count;
  };
  const auto tiles_along = [this, radius](double centre, const Axis& axis) -> Runs {
    constexpr double kFar = 1e15;
    const double node = (centre - axis.begin_m) * nodes_per_m_;
    const double reach = std::abs(radius) * nodes_per_m_;
    const Runs all{{{0, (axis.nodes - 1) / kTileNodes}, {}}, 1};
    if (!(std::abs(node) < kFar && reach < kFar)) return all;
    auto low = static_cast<int64_t>(std::floor(node - reach));
    auto high = static_cast<int64_t>(std::floor(node + reach)) + 1;
    if (!wrap_) {
      const int64_t last = axis.nodes - 1;
      return {{{static_cast<int>(std::clamp<int64_t>(low, 0, last)) / kTileNodes,
                static_cast<int>(std::clamp<int64_t>(high, 0, last)) / kTileNodes},
               {}},
              1};
    }
    if (high - low + 1 >= axis.nodes) return all;
    const int64_t nodes = axis.nodes;
    const auto wrapped = [nodes](int64_t n) {
      return static_cast<int>(((n % nodes) + nodes) % nodes);
    };
    const int first = wrapped(low) / kTileNodes;
    const int last = wrapped(high) / kTileNodes;
    if (wrapped(low) <= wrapped(high)) return {{{first, last}, {}}, 1};
    return {{{0, last}, {first, (axis.nodes - 1) / kTileNodes}}, 2};
  };

  const Runs runs_x = tiles_along(x, x_axis_);
  const Runs runs_y = tiles_along(y, y_axis_);
  Height highest = std::numeric_limits<Height>::min();
  for (int j = 0; j < runs_y.count; ++j) {
    for (int ty = runs_y.run[j].first; ty <= runs_y.run[j].last; ++ty) {
      for (int i = 0; i < runs_x.count; ++i) {
        for (int tx = runs_x.run[i].first; tx <= runs_x.run[i].last; ++tx) {
          highest = std::max(highest, tile_highest_[tile_index(tx, ty)]);
        }
      }
    }
  }
  return highest * kHeightUnit_m;
}

void HeightField::refresh_bounds() {
  tile_highest_.assign(tile_highest_.size(), std::numeric_limits<Height>::min());
  for (int iy = 0; iy < ny(); ++iy) {
    for (int ix = 0; ix < nx(); ++ix) set_node(ix, iy, node(ix, iy));
  }
}

double HeightField::steepest_gradient() const {
  double steepest_squared = 0.0;
  for (int iy = 0; iy < cells_y(); ++iy) {
    for (int ix = 0; ix < cells_x(); ++ix) {
      const CellHeights c = cell(ix, iy);
      const auto rise = [](Height from, Height to) {
        return std::abs(static_cast<double>(to) - static_cast<double>(from));
      };
      const double along_x =
          std::max(rise(c.south_west, c.south_east), rise(c.north_west, c.north_east));
      const double along_y =
          std::max(rise(c.south_west, c.north_west), rise(c.south_east, c.north_east));
      steepest_squared = std::max(steepest_squared, along_x * along_x + along_y * along_y);
    }
  }
  return std::sqrt(steepest_squared) * gradient_scale_;
}

int64_t HeightField::height_sum() const {
  return std::accumulate(heights_.begin(), heights_.end(), int64_t{0});
}

}  // namespace screed
