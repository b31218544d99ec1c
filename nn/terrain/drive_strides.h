// A recorded drive in strides of a few frames: where the robot went, how far its wheels turned, and
// what that did to the ground. What networks of the terrain learn from and are compared with.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/vehicle/assembly.h"
#include "host_sim/run/session/session_reader.h"
#include "nn/terrain/stride.h"

namespace screed::nn {

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

}  // namespace screed::nn
