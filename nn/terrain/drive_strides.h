// A drive in strides of a few frames: where the robot went, how far its wheels turned, and what
// that did to the ground; how close what a network says of it comes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/run/session/session_reader.h"

namespace screed::nn {

/// Frames of a stride: 50 ms, in which the robot comes about as far as a cell of the ground.
inline constexpr std::uint64_t kStrideFrames = 5;
inline constexpr double kStrideRate_hz = 100.0 / kStrideFrames;

/// Where a wheel stands under the robot, m: x forward, y left.
struct WheelPosition {
  double x = 0.0;
  double y = 0.0;
  double radius_m = 0.0;
  bool front = false;
};
/// Front left, front right, rear left, rear right.
std::array<WheelPosition, 4> wheel_positions(const Assembly& robot);

struct Stride {
  double x_m = 0.0;  ///< at its end, on the bed
  double y_m = 0.0;
  double yaw_rad = 0.0;
  double forward_m = 0.0;  ///< during it, in the robot's axes at its end
  double sideways_m = 0.0;
  double turn_rad = 0.0;
  std::array<double, 2> track_m{};  ///< travel of the wheels' surfaces, left and right
  double v_left = 0.0;              ///< Table 5.1, at its end: rad/s, rad
  double v_right = 0.0;
  double pitch = 0.0;
  double roll = 0.0;
};

/// A recorded drive: what networks of the terrain learn from and are compared with.
class DriveStrides {
 public:
  /// Throws InputError when the run cannot be read or its heights were not recorded.
  explicit DriveStrides(const std::filesystem::path& run);

  std::size_t size() const { return strides_.size(); }
  const Stride& operator[](std::size_t i) const { return strides_[i]; }
  const std::array<WheelPosition, 4>& wheels() const { return wheels_; }
  const Assembly& robot() const { return robot_; }
  bool tracks() const { return tracks_; }

  /// The ground before the first stride.
  HeightField initial_terrain() const;
  /// The ground after so many strides.
  HeightField terrain_after(std::size_t strides) const;
  /// Brings a field that shows the ground before stride i to the ground after it.
  void advance(std::size_t i, HeightField& ground) const;

 private:
  SessionReader session_;
  std::uint64_t first_frame_ = 0;  ///< the robot stands until here
  Assembly robot_;
  bool tracks_ = false;
  std::array<WheelPosition, 4> wheels_{};
  std::vector<Stride> strides_;
};

/// How close predicted terrain is to the recorded one.
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
