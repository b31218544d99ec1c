// Measures how level a surface is and what it has cost, relative to the surface at the start.
#pragma once

#include <optional>

#include "host_sim/leveling/leveling_point.h"
#include "host_sim/leveling/traversability.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

/// The robot's share of a point.
struct LevelingCost {
  double time_s = 0.0;
  double distance_m = 0.0;
  double energy_j = 0.0;
  Traversability traversability;
};

class LevelingMeter {
 public:
  /// flat_deg: slope up to which a cell is flat, at both scales, 0..89.
  explicit LevelingMeter(double flat_deg) : flat_deg_(flat_deg) {}

  /// with_transport: the four figures of optimal transport as well, some 15 ms. Those of the first
  /// surface that is measured with them are the start, from which progress counts; on a level start
  /// progress is not a number.
  LevelingPoint measure(const HeightField& surface, const LevelingCost& cost, bool with_transport);
  /// A point without transport of a surface that is as it was when `earlier` was measured.
  static LevelingPoint unchanged(const LevelingPoint& earlier, const LevelingCost& cost);

 private:
  void add_transport(const HeightField& surface, LevelingPoint& point);

  double flat_deg_;
  std::optional<double> start_;  ///< transport at the start, m3 m
};

}  // namespace screed
