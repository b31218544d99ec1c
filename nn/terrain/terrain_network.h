// Networks that say what wheels do to the ground in a stride, each as a file: the fluxes of soil
// under every wheel, and the thesis' window round the robot.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "nn/terrain/drive_strides.h"

namespace screed::nn {

/// What a wheel does to the ground in a stride, as soil that moves between neighbouring cells of a
/// patch under it. Every flux takes from one cell what it gives to the next, in whole units of
/// height: the volume of the ground stays the same to the last bit, whatever the weights are.
///
/// One small network, the same for every cell of every wheel: how far the cells round it reach into
/// the wheel, where it lies under the wheel, how the wheel moves -> a tanh layer -> the fluxes out
/// of its front and its left side.
class FluxNetwork {
 public:
  static constexpr int kCellsX = 22;  ///< along the robot
  static constexpr int kCellsY = 16;  ///< across
  static constexpr double kCell_m = 0.005;
  static constexpr std::size_t kCells = std::size_t{kCellsX} * kCellsY;
  /// Cells round a cell that its fluxes depend on, either way.
  static constexpr int kReachX = 2;
  static constexpr int kReachY = 4;
  static constexpr int kObservedX = kCellsX + 2 * kReachX;  ///< cells that are looked at
  static constexpr int kObservedY = kCellsY + 2 * kReachY;
  static constexpr std::size_t kObservedCells = std::size_t{kObservedX} * kObservedY;
  static constexpr std::size_t kMotions = 8;
  static constexpr std::size_t kObservation = kObservedCells + kMotions;  ///< of a patch
  static constexpr std::size_t kNeighbours = std::size_t{2 * kReachX + 1} * (2 * kReachY + 1);
  static constexpr std::size_t kInputs = kNeighbours + 2 + kMotions;  ///< of a cell
  static constexpr std::size_t kFluxesX = std::size_t{kCellsX - 1} * kCellsY;
  static constexpr std::size_t kFluxes = kFluxesX + std::size_t{kCellsX} * (kCellsY - 1);
  /// One in the outputs is so many metres of height.
  static constexpr double kOutput_m = 0.0005;

  /// Weights at random, from the seed.
  FluxNetwork(std::size_t hidden, std::uint64_t seed);
  /// Nothing when the file is no such network.
  static std::optional<FluxNetwork> read(const std::filesystem::path& file);
  void write(const std::filesystem::path& file) const;

  std::size_t hidden() const { return hidden_; }
  std::size_t weights() const { return first_.size() + second_.size(); }
  /// A row a hidden node: weights of its inputs, then its bias.
  std::vector<float>& first() { return first_; }
  /// A row for the flux forward, one for the flux to the left: hidden nodes, then the bias.
  std::vector<float>& second() { return second_; }

  /// The cells of the patch under a wheel in the world, by the stride's end; y mirrored for wheels
  /// on the right, so that one network does for both sides.
  struct Patch {
    double x_m;  ///< its middle
    double y_m;
    double cos_yaw;
    double sin_yaw;
    bool mirrored;

    std::array<double, 2> cell(int ix, int iy) const;
  };
  static Patch patch_under(const WheelPosition& wheel, const Stride& stride);
  /// What the wheels stand on.
  struct WheelSupport {
    std::array<double, 4> height_m{};  ///< of the ground under each, a mean over its footprint
    /// Over the plane of the robot's pitch and roll through the two that stand highest: those carry
    /// a stiff robot; a wheel far below hangs in the air.
    std::array<double, 4> support_m{};
  };
  static WheelSupport wheel_support(const HeightField& ground,
                                    const std::array<WheelPosition, 4>& wheels,
                                    const Stride& stride);
  /// kObservation numbers: the ground round a wheel and its motion.
  static void observe(const HeightField& ground, const Patch& patch, const WheelPosition& wheel,
                      double height_m, double support_m, const Stride& stride,
                      std::span<float> observation);
  /// kInputs numbers: what a cell's fluxes depend on.
  static void inputs_of(std::span<const float> observation, int ix, int iy, float* inputs);

  /// kFluxes numbers: positive towards larger ix or iy.
  void evaluate(std::span<const float> observation, std::span<float> fluxes) const;

  /// Moves the soil under all wheels.
  void apply(HeightField& ground, const std::array<WheelPosition, 4>& wheels,
             const Stride& stride) const;

 private:
  std::size_t hidden_;
  std::vector<float> first_;
  std::vector<float> second_;
};

/// Of flux i: the cells it leads from and to.
struct FluxCells {
  std::size_t from;
  std::size_t to;
  std::size_t row;  ///< 0: forward, 1: to the left
};
FluxCells cells_of(std::size_t flux);

/// Takes units of height from the ground round one place and gives them to another, spread over the
/// four nodes round each; the sum over all nodes stays the same.
void move_soil(HeightField& ground, const std::array<double, 2>& from,
               const std::array<double, 2>& to, Height units);

/// The terrain network of the thesis (6.3.1), at a reduced size: a window round the robot, axes as
/// the map's; in go the wheels' speeds, pitch, roll and what changed in the window in the stride
/// before, out comes what changes now. All of its layers are linear, with batch normalisation
/// between them, so the trained network as a whole is one linear map and a constant; that map is
/// what is kept and used.
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

  /// kCells rows of kInputs, and a constant a row.
  WindowNetwork(std::vector<float> matrix, std::vector<float> constant)
      : matrix_(std::move(matrix)), constant_(std::move(constant)) {}
  /// Nothing when the file is no such network.
  static std::optional<WindowNetwork> read(const std::filesystem::path& file);
  /// Some 12 MB.
  void write(const std::filesystem::path& file) const;

  /// Changes the ground, and `last`: kCells numbers, what it changed in the stride before in units
  /// of kOutput_m; zeros at first.
  void apply(HeightField& ground, const Stride& stride, std::vector<float>& last) const;

  /// The last kMotions of the inputs.
  static void add_motion(const Stride& stride, std::span<float> inputs);
  /// What changed in the window, kCells numbers in units of kOutput_m.
  static void observe(const HeightField& before, const HeightField& after, const Stride& stride,
                      std::span<float> cells);

 private:
  std::vector<float> matrix_;
  std::vector<float> constant_;
};

/// Changes the ground by a stride of one robot; called stride after stride.
using GroundChange = std::function<void(HeightField& ground, const Stride& stride)>;

/// A trained network of either kind as what a robot on wheels does to the ground below it.
struct TerrainNetwork {
  std::string kind;  ///< "fluxes" or "window"
  /// For a robot that begins to drive.
  std::function<GroundChange(const Assembly& robot)> change;
};

/// Throws InputError, naming the file, when it holds neither.
TerrainNetwork read_terrain_network(const std::filesystem::path& file);

}  // namespace screed::nn
