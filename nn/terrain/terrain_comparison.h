// How close predicted terrain is to the recorded one: heights, volume, ruts.
#pragma once

#include <cstddef>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "nn/terrain/drive_strides.h"

namespace screed::nn {

struct TerrainComparison {
  double touched_m2 = 0.0;        ///< area whose height was changed by more than 0.1 mm in truth
  double true_change_mm = 0.0;    ///< RMS of the true change there
  double error_mm = 0.0;          ///< RMSE there
  double outside_mm = 0.0;        ///< RMS of what was changed elsewhere on the bed
  double moved_cm3 = 0.0;         ///< volume that was lowered, predicted
  double volume_cm3 = 0.0;        ///< net change of the volume, predicted; 0 in truth
  std::int64_t volume_units = 0;  ///< the same, as sum of all heights
};

/// All three on one grid.
TerrainComparison compare(const HeightField& before, const HeightField& real,
                          const HeightField& predicted);

/// Ruts in a cross-section of the path, on average over the strides: a rut is where the
/// change goes below a third of the deepest of that cross-section, and what rises above a tenth of
/// it in between parts two. Only strides that go straight on, away from where the robot stands at
/// the ends, are looked at; cross-sections without a rut of 0.2 mm count as none.
struct RutCount {
  double mean = 0.0;
  std::vector<std::size_t> histogram;  ///< cross-sections with so many ruts
};
RutCount count_ruts(const HeightField& before, const HeightField& after,
                    const std::vector<Stride>& path);

}  // namespace screed::nn
