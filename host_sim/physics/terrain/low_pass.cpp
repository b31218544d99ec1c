// Separable: a pass along the rows, then one along the columns. Both take blocks of neighbours in
// memory at once. Each sample's sum is in the order of the weights, so that blocks change no bit.
#include "host_sim/physics/terrain/low_pass.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <sstream>

#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"

namespace screed {

// Two doubles at once, with the compilers' own vector types: element by element the same operations
// and so the same bits as one at a time.

using Double2 = double __attribute__((vector_size(16)));
/// Of comparisons: all bits set where true.
using Mask2 = decltype(Double2{} < Double2{});

inline Double2 broadcast(double value) {
  return Double2{value, value};
}
inline Double2 load(const double* from) {
  Double2 lanes;
  std::memcpy(&lanes, from, sizeof lanes);
  return lanes;
}
inline void store(Double2 lanes, double* to) {
  std::memcpy(to, &lanes, sizeof lanes);
}
inline Double2 minimum(Double2 a, Double2 b) {
  return a < b ? a : b;
}
inline Double2 maximum(Double2 a, Double2 b) {
  return a > b ? a : b;
}
inline Double2 magnitude(Double2 a) {
  return maximum(a, -a);
}
inline Double2 square_root(Double2 a) {
  return Double2{std::sqrt(a[0]), std::sqrt(a[1])};
}
inline double sum(Double2 a) {
  return a[0] + a[1];
}

namespace {

/// w[0] of the sample itself, w[k] of its neighbours k samples away, either side.
std::vector<double> gaussian_weights(double sigma) {
  const int reach = static_cast<int>(std::ceil(4.0 * sigma));
  std::vector<double> weights;
  weights.reserve(static_cast<size_t>(reach) + 1);
  double sum = 0.0;
  for (int k = 0; k <= reach; ++k) {
    weights.push_back(portable::exp(-0.5 * (k / sigma) * (k / sigma)));
    sum += k == 0 ? weights.back() : 2.0 * weights.back();
  }
  for (double& weight : weights) weight /= sum;
  return weights;
}

/// The sample that stands at place i, which may lie beyond the `count` samples.
size_t sample_at(int i, int count, FilterEdge edge) {
  const auto modulo = [](int value, int period) { return ((value % period) + period) % period; };
  if (edge == FilterEdge::kWrapped) return static_cast<size_t>(modulo(i, count));
  if (edge == FilterEdge::kRepeated) return static_cast<size_t>(std::clamp(i, 0, count - 1));
  const int within = modulo(i, 2 * count);
  return static_cast<size_t>(within < count ? within : 2 * count - 1 - within);
}

/// The samples that stand at places -reach .. count + reach - 1.
std::vector<size_t> samples_along(int count, int reach, FilterEdge edge) {
  std::vector<size_t> samples;
  samples.reserve(static_cast<size_t>(count) + 2 * static_cast<size_t>(reach));
  for (int i = -reach; i < count + reach; ++i) samples.push_back(sample_at(i, count, edge));
  return samples;
}

constexpr size_t kBlock = 8;

/// to = weights[0] at(0) + weights[1] (at(-1) + at(1)) + ..., for `count` neighbours in memory, at
/// most kBlock; at(k) points to the samples k places along the filter's direction.
template <typename At>
void weigh(double* to, size_t count, const std::vector<double>& weights, const At& at) {
  const auto reach = static_cast<std::ptrdiff_t>(weights.size()) - 1;
  if (count < kBlock) {
    for (size_t i = 0; i < count; ++i) {
      double sum = weights[0] * at(0)[i];
      for (std::ptrdiff_t k = 1; k <= reach; ++k)
        sum += weights[static_cast<size_t>(k)] * (at(-k)[i] + at(k)[i]);
      to[i] = sum;
    }
    return;
  }
  std::array<Double2, kBlock / 2> sums;
  for (size_t i = 0; i < sums.size(); ++i) sums[i] = broadcast(weights[0]) * load(at(0) + 2 * i);
  for (std::ptrdiff_t k = 1; k <= reach; ++k) {
    const Double2 weight = broadcast(weights[static_cast<size_t>(k)]);
    const double* const before = at(-k);
    const double* const after = at(k);
    for (size_t i = 0; i < sums.size(); ++i)
      sums[i] += weight * (load(before + 2 * i) + load(after + 2 * i));
  }
  for (size_t i = 0; i < sums.size(); ++i) store(sums[i], to + 2 * i);
}

}  // namespace

void gaussian_filter(std::vector<double>& samples, int width, int height, double sigma,
                     FilterEdge edge) {
  const std::vector<double> weights = gaussian_weights(sigma);
  const int reach = static_cast<int>(weights.size()) - 1;
  const auto row_length = static_cast<size_t>(width);
  const auto rows = static_cast<size_t>(height);

  const std::vector<size_t> along_row = samples_along(width, reach, edge);
  std::vector<double> line(along_row.size());
  for (size_t row = 0; row < rows; ++row) {
    double* const begin = samples.data() + row * row_length;
    for (size_t i = 0; i < line.size(); ++i) line[i] = begin[along_row[i]];
    for (size_t x = 0; x < row_length; x += kBlock) {
      const double* const middle = line.data() + reach + x;
      weigh(begin + x, std::min(kBlock, row_length - x), weights,
            [middle](std::ptrdiff_t k) { return middle + k; });
    }
  }

  const std::vector<size_t> along_column = samples_along(height, reach, edge);
  const std::vector<double> source = samples;
  for (size_t x = 0; x < row_length; x += kBlock) {  // a column of blocks stays in the cache
    for (size_t row = 0; row < rows; ++row) {
      const size_t* const middle = along_column.data() + reach + row;
      weigh(samples.data() + row * row_length + x, std::min(kBlock, row_length - x), weights,
            [&](std::ptrdiff_t k) { return source.data() + middle[k] * row_length + x; });
    }
  }
}

// The mean plane goes before the filter, so that a slope does not bend at the edges of its bed.

MeanPlane mean_plane(const HeightField& field) {
  const double count = static_cast<double>(field.nx()) * field.ny();
  MeanPlane plane;
  plane.height_m = static_cast<double>(field.height_sum()) / count * kHeightUnit_m;
  if (field.wrap()) return plane;
  // The nodes lie symmetrically about (0, 0), so that the three equations separate.
  double moment_x = 0.0;
  double moment_y = 0.0;
  double squares_x = 0.0;
  double squares_y = 0.0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    const double y = field.node_y(iy);
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double x = field.node_x(ix);
      const double height = field.node(ix, iy) * kHeightUnit_m - plane.height_m;
      moment_x += x * height;
      moment_y += y * height;
      squares_x += x * x;
      squares_y += y * y;
    }
  }
  plane.slope_x = moment_x / squares_x;
  plane.slope_y = moment_y / squares_y;
  return plane;
}

FilteredHeights filter_heights(const HeightField& field, double sigma_m) {
  if (!(sigma_m >= 1e-4 && sigma_m <= 100.0)) {
    std::ostringstream message;
    message << "low-pass: sigma_m = " << sigma_m << "; allowed: 0.0001 to 100";
    throw InputError(message.str());
  }
  FilteredHeights result;
  result.plane = mean_plane(field);
  result.heights_m.reserve(static_cast<size_t>(field.nx()) * static_cast<size_t>(field.ny()));
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      result.heights_m.push_back(field.node(ix, iy) * kHeightUnit_m -
                                 result.plane.at(field.node_x(ix), field.node_y(iy)));
    }
  }
  result.low_m = result.heights_m;
  gaussian_filter(result.low_m, field.nx(), field.ny(), sigma_m / field.spacing_m(),
                  field.wrap() ? FilterEdge::kWrapped : FilterEdge::kReflected);
  return result;
}

HeightField low_passed(const HeightField& field, double sigma_m) {
  const FilteredHeights heights = filter_heights(field, sigma_m);
  HeightField result(field.nx(), field.ny(), field.spacing_m(), field.wrap());
  size_t node = 0;
  for (int iy = 0; iy < field.ny(); ++iy) {
    for (int ix = 0; ix < field.nx(); ++ix) {
      const double height =
          heights.plane.at(field.node_x(ix), field.node_y(iy)) + heights.low_m[node++];
      result.set_node(ix, iy, static_cast<Height>(std::lround(height / kHeightUnit_m)));
    }
  }
  result.refresh_bounds();
  return result;
}

}  // namespace screed
