// A histogram of slopes.
#include "tools/screed/viewer/slope_statistics.h"

#include <algorithm>
#include <cmath>

#include "host_sim/core/constants.h"
#include "host_sim/physics/terrain/terrain_statistics.h"

namespace screed::viewer {
namespace {

constexpr size_t kBins = 90 * SlopeStatistics::kBinsPerDegree + 1;

}  // namespace

SlopeStatistics::SlopeStatistics(const HeightField& field, double flat_deg)
    : cells_x_(field.cells_x()),
      cells_y_(field.cells_y()),
      flat_bins_(static_cast<int>(std::lround(flat_deg * kBinsPerDegree))),
      bins_(static_cast<size_t>(cells_x_) * static_cast<size_t>(cells_y_)),
      counts_(kBins) {
  for (int y = 0; y < cells_y_; ++y) {
    for (int x = 0; x < cells_x_; ++x) {
      const uint16_t bin = bin_of(field, x, y);
      bins_[static_cast<size_t>(y) * static_cast<size_t>(cells_x_) + static_cast<size_t>(x)] = bin;
      ++counts_[bin];
      sum_ += bin;
    }
  }
}

/// Rounded up, so that a cell within the limit is one of a bin within it, also but for the rounding
/// of heights, as in flatness().
uint16_t SlopeStatistics::bin_of(const HeightField& field, int cell_x, int cell_y) const {
  const double gradient = cell_gradient(field, cell_x, cell_y) - gradient_rounding(field);
  const double slope_deg = std::atan(std::max(0.0, gradient)) * kDegPerRad;
  constexpr double kRounding = 1e-9;
  return static_cast<uint16_t>(std::min<size_t>(
      kBins - 1, static_cast<size_t>(std::ceil(slope_deg * kBinsPerDegree - kRounding))));
}

void SlopeStatistics::look_at_cell(const HeightField& field, int cell_x, int cell_y) {
  uint16_t& known = bins_[static_cast<size_t>(cell_y) * static_cast<size_t>(cells_x_) +
                          static_cast<size_t>(cell_x)];
  const uint16_t bin = bin_of(field, cell_x, cell_y);
  if (bin == known) return;
  --counts_[known];
  ++counts_[bin];
  sum_ += bin;
  sum_ -= known;
  known = bin;
}

void SlopeStatistics::update(const HeightField& field, std::span<const HeightChange> changes) {
  const auto nodes_x = static_cast<uint32_t>(field.nx());
  const auto cell = [&](int at, int cells) {
    if (field.wrap()) return at < 0 ? cells - 1 : at;
    return at;
  };
  for (const HeightChange& change : changes) {
    const int x = static_cast<int>(change.node % nodes_x);
    const int y = static_cast<int>(change.node / nodes_x);
    for (const int cell_y : {cell(y - 1, cells_y_), y}) {
      for (const int cell_x : {cell(x - 1, cells_x_), x}) {
        if (cell_x < 0 || cell_y < 0 || cell_x >= cells_x_ || cell_y >= cells_y_) continue;
        look_at_cell(field, cell_x, cell_y);
      }
    }
  }
}

SlopeFigures SlopeStatistics::figures() const {
  SlopeFigures figures;
  const auto cells = static_cast<double>(bins_.size());
  // A bin stands for its middle.
  const auto degrees = [](double bin) { return std::max(0.0, bin - 0.5) / kBinsPerDegree; };
  figures.mean_deg = std::max(0.0, (static_cast<double>(sum_) -
                                    0.5 * (cells - static_cast<double>(counts_.front()))) /
                                       cells) /
                     kBinsPerDegree;
  uint64_t below = 0;
  bool p95_found = false;
  for (size_t bin = 0; bin < counts_.size(); ++bin) {
    below += counts_[bin];
    if (static_cast<int>(bin) == flat_bins_) figures.flat = static_cast<double>(below) / cells;
    if (counts_[bin] != 0) figures.steepest_deg = degrees(static_cast<double>(bin));
    if (!p95_found && static_cast<double>(below) >= 0.95 * cells) {
      figures.p95_deg = degrees(static_cast<double>(bin));
      p95_found = true;
    }
  }
  return figures;
}

}  // namespace screed::viewer
