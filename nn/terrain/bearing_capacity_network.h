// Bearing capacity of soil below the tracks of a driving robot, relative to Bekker's law for a
// standing one: the network of TrackSoilModel. Its inputs are the soil, the robot's motion and the
// sinkage that the terrain below its tracks has already; its outputs are factors and shares that
// TrackSoilModel's closed form works with (BearingCapacity); all are bounded, so no weights can
// make a robot dig itself in.
//
// One tanh layer of a few nodes: it is trained by an evolution strategy
// (bearing_capacity_trainer.h), not by gradients.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace screed::nn {

/// What the closed form works with; by itself with these numbers, fitted by hand.
struct BearingCapacity {
  /// Unloading stiffness in equilibrium and in compaction, over the soil's mean stiffness at 2 kPa:
  /// softer than the soil's own E, so that one compacted cell does not hold a track up.
  double equilibrium_stiffness = 10.0;
  double compaction_stiffness = 20.0;
  double load = 1.15;           ///< share of the robot's weight that presses
  double rear_reduction = 0.2;  ///< reduction of the capacity below a track's trailing end
  double uplift = 0.16;  ///< share of the track's rise along its path that the soil does not follow
  double mass_offset_m = 0.0;  ///< shift of the centre of mass in the direction of travel
  double relaxation = 1.0;  ///< share of the displacement to equilibrium that it makes in a stride
};

class BearingCapacityNetwork {
 public:
  static constexpr std::size_t kInputs = 11;
  static constexpr std::size_t kOutputs = 7;

  /// Equals the closed form, its hidden nodes random.
  BearingCapacityNetwork(std::size_t hidden, std::uint64_t seed);
  /// Throws InputError when the file is no such network.
  static BearingCapacityNetwork read(const std::filesystem::path& file);
  void write(const std::filesystem::path& file) const;

  std::size_t hidden() const { return hidden_; }
  /// A row a hidden node, then a row an output: weights, then the bias.
  std::vector<float>& weights() { return weights_; }
  const std::vector<float>& weights() const { return weights_; }

  BearingCapacity evaluate(std::span<const float> inputs) const;

 private:
  std::size_t hidden_;
  std::vector<float> weights_;
};

}  // namespace screed::nn
