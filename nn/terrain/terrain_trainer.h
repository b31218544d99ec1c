// Trains networks of the terrain on what recorded wheels did to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "nn/terrain/drive_strides.h"
#include "nn/terrain/terrain_network.h"
#include "nn/training/trainer.h"

namespace screed::nn {

/// Patches with what happened in them: a row an example.
struct FluxExamples {
  std::vector<float> observations;  ///< kObservation each
  std::vector<float> changes;       ///< kCells each, in units of kOutput_m

  std::size_t rows() const { return changes.size() / FluxNetwork::kCells; }
};

/// Every `every`-th stride's four wheels.
void add_examples(const DriveStrides& drive, std::size_t every, FluxExamples& examples);

/// Adam with batches of 16; the rate falls to a tenth. The losses are mean squared errors of the
/// heights' change a cell, in mm^2.
void train(FluxNetwork& network, const FluxExamples& examples, std::size_t epochs,
           std::uint64_t seed, const EpochProgress& progress);

/// On every stride of the drives: Adam, batches of 32. What the layers come to.
WindowNetwork train_window(const std::vector<const DriveStrides*>& drives, std::size_t epochs,
                           std::uint64_t seed, const EpochProgress& progress);

}  // namespace screed::nn
