// Trains a bearing-capacity network on simulated drives: its terrain is compared with the recorded
// one after some seconds on its own, and weights that leave less error are kept (CMA-ES). There is
// no gradient through contact, and none is needed for a hundred weights.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "nn/terrain/bearing_capacity_network.h"
#include "nn/terrain/track_soil_model.h"

namespace screed::nn {

/// Some seconds of a recorded drive on a piece of its bed, without wrap-around.
struct DriveSegment {
  HeightField before;
  HeightField sinkage;  ///< by earlier passes (TrackSoilModel::sinkage)
  HeightField after;
  std::vector<Stride> path;  ///< positions on the segment's terrain
  SoilParameters soil;
  TrackGeometry tracks;
  double change_mm = 0.0;  ///< RMS where the ground was touched
};

/// Up to `most` segments of a drive with tracks, spread over it; those that cross the bed's edges
/// are left out. Throws InputError when it has wheels, or ground other than soil.
std::vector<DriveSegment> segments_of(const DriveStrides& drive, std::size_t most, double seconds);

/// Mean squared error where the ground was touched, as a share of that of no change at all. The
/// closed form when the network is null.
double relative_error(const DriveSegment& segment, const BearingCapacityNetwork* network);

/// Separable CMA-ES (Ros and Hansen, 2008): in each generation every candidate is evaluated on the
/// same segment of each drive, another one in the next. `drives`: segments_of each. The generation
/// and the mean error of its candidates are passed to `progress`.
void train(BearingCapacityNetwork& network, const std::vector<std::vector<DriveSegment>>& drives,
           std::size_t generations, std::uint64_t seed,
           const std::function<void(std::size_t, double)>& progress);

}  // namespace screed::nn
