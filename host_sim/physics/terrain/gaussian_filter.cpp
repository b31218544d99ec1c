// Separable: a pass along the rows, then one along the columns. Both take blocks of neighbours in
// memory at once. Each sample's sum is in the order of the weights, so that blocks change no bit.
#include "host_sim/physics/terrain/gaussian_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "host_sim/core/elementary.h"
#include "host_sim/physics/terrain/double2.h"

namespace screed {
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

}  // namespace screed
