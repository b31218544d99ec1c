// The terrain network of the thesis (6.3.1), at a reduced size: a window round the robot, axes as
// the map's; in go the wheels' speeds, pitch, roll and what changed in the window in the stride
// before, out comes what changes now. All of its layers are linear, with batch normalisation
// between them, so the trained network as a whole is one linear map and a constant; that map is
// what is kept and used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "nn/terrain/drive_strides.h"

namespace screed::nn {

class WindowNetwork {
 public:
  static constexpr int kSide = 32;         ///< cells; the thesis: 128
  static constexpr double kCell_m = 0.02;  ///< 0.64 m in all, as 128 of 5 mm
  static constexpr std::size_t kCells = std::size_t{kSide} * kSide;
  static constexpr std::size_t kMotions = 4;
  static constexpr std::size_t kInputs = kCells + kMotions;
  static constexpr std::size_t kHiddenLayers = 20;
  static constexpr std::size_t kHiddenNodes = 100;  ///< the thesis: 500
  static constexpr double kOutput_m = 0.0001;       ///< one in the outputs

  /// Trained on every stride of the drives: Adam, batches of 32. What the layers come to.
  WindowNetwork(const std::vector<const DriveStrides*>& drives, std::size_t epochs,
                std::uint64_t seed, const std::function<void(std::size_t, double)>& progress);
  /// Throws InputError when the file is no such network.
  static WindowNetwork read(const std::filesystem::path& file);
  /// Some 12 MB.
  void write(const std::filesystem::path& file) const;

  /// Changes the ground, and `last`: kCells numbers, what it changed in the stride before in units
  /// of kOutput_m; zeros at first.
  void apply(HeightField& ground, const Stride& stride, std::vector<float>& last) const;

  static void add_motion(const Stride& stride, std::span<float> inputs);

 private:
  WindowNetwork() = default;

  std::vector<float> matrix_;  ///< kCells rows of kInputs
  std::vector<float> constant_;
};

}  // namespace screed::nn
