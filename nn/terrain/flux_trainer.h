// Trains a flux network on what recorded wheels did to the terrain.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "nn/terrain/drive_strides.h"
#include "nn/terrain/flux_network.h"

namespace screed::nn {

/// Patches with what happened in them: a row an example.
struct FluxExamples {
  std::vector<float> observations;  ///< kObservation each
  std::vector<float> changes;       ///< kCells each, in units of kOutput_m

  std::size_t rows() const { return changes.size() / FluxNetwork::kCells; }
};

/// Every `every`-th stride's four wheels.
void add_examples(const DriveStrides& drive, std::size_t every, FluxExamples& examples);

/// Adam with batches of 16; the rate falls to a tenth. Mean squared error of the heights' change a
/// cell and the epoch, in mm^2, is passed to `progress`.
void train(FluxNetwork& network, const FluxExamples& examples, std::size_t epochs,
           std::uint64_t seed, const std::function<void(std::size_t, double)>& progress);

}  // namespace screed::nn
