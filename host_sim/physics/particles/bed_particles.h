// The particles of a bed, an array a property, and the box that they are in.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "host_sim/physics/particles/bed_kernel.h"
#include "host_sim/physics/particles/bed_layout.h"

namespace screed {

/// Numbers of particles count up in tiles (bed_layout.h), so that so many neighbours of number have
/// most of their contacts among themselves: they are computed together, their rows in the cache of
/// one core. Sums go in an order that this number, but no number of threads, has a part in.
constexpr size_t kGroupParticles = 2048;

inline size_t group_of(int32_t particle) {
  return static_cast<size_t>(particle) / kGroupParticles;
}
inline int32_t base_of(size_t group) {
  return static_cast<int32_t>(group * kGroupParticles);
}

/// Rows of all particles, and one of nobody.
struct BedParticles {
  explicit BedParticles(const std::vector<Eigen::Vector3d>& centres)
      : size(centres.size()),
        groups((size + kGroupParticles - 1) / kGroupParticles),
        place(size + 1, PlaceRow{}),
        motion(size + 1, MotionRow{}),
        anchor(size, AnchorRow{}),
        state(size, 0) {
    for (size_t i = 0; i < size; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        place[i].at[axis] = anchor[i].at[axis] = centres[i][axis];
      }
    }
  }

  int32_t nobody() const { return static_cast<int32_t>(size); }
  Eigen::Vector3d at(int32_t particle) const {
    return Eigen::Vector3d(place[static_cast<size_t>(particle)].at);
  }
  bool awake(int32_t particle) const { return state[static_cast<size_t>(particle)] != 0; }
  /// At rest in any case.
  void set_awake(int32_t particle, bool awake, double now_s) {
    const auto i = static_cast<size_t>(particle);
    state[i] = awake ? 1 : 0;
    motion[i] = {};
    motion[i].awake = awake ? 1.0 : 0.0;
    motion[i].since_s = now_s;
  }

  size_t size;
  size_t groups;
  std::vector<PlaceRow> place;
  std::vector<MotionRow> motion;
  std::vector<AnchorRow> anchor;
  std::vector<uint8_t> state;  ///< 1 of those awake, as in their motion, for those who ask often
};

/// From one place to another by the shortest path, in a bed that may repeat.
inline Eigen::Vector3d between(const BedExtent& extent, const Eigen::Vector3d& from,
                               const Eigen::Vector3d& to) {
  Eigen::Vector3d separation = to - from;
  if (extent.periodic) {
    separation.x() -= extent.width_m * std::round(separation.x() / extent.width_m);
    separation.y() -= extent.depth_m * std::round(separation.y() / extent.depth_m);
  }
  return separation;
}

}  // namespace screed
