// The slope of every cell and statistics of them, kept up to date at the cost of what
// changes: statistics of a bed of 360,000 cells at every frame.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/run/session/session_layout.h"

namespace screed::viewer {

/// Of all cells, each at its centre; as terrain_statistics() and flatness() to the resolution of
/// the bins.
struct SlopeFigures {
  double mean_deg = 0.0;
  double p95_deg = 0.0;
  double steepest_deg = 0.0;
  double flat = 0.0;  ///< share of cells within the limit, 0..1

  bool operator==(const SlopeFigures&) const = default;
};

class SlopeStatistics {
 public:
  static constexpr int kBinsPerDegree = 50;

  /// flat_deg: up to this slope a cell is flat, 0..89.
  SlopeStatistics(const HeightField& field, double flat_deg);

  /// These heights of the field have changed.
  void update(const HeightField& field, std::span<const HeightChange> changes);

  SlopeFigures figures() const;
  double flat_limit_deg() const { return static_cast<double>(flat_bins_) / kBinsPerDegree; }

 private:
  uint16_t bin_of(const HeightField& field, int cell_x, int cell_y) const;
  void look_at_cell(const HeightField& field, int cell_x, int cell_y);

  int cells_x_;
  int cells_y_;
  int flat_bins_;
  std::vector<uint16_t> bins_;    // of each cell
  std::vector<uint32_t> counts_;  // of each bin
  uint64_t sum_ = 0;              // of all cells' bins
};

}  // namespace screed::viewer
