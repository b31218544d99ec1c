// Ground that never deforms: a height field and nothing else.
#pragma once

#include <utility>

#include "host_sim/physics/terrain/terrain.h"

namespace screed {

class RigidTerrain final : public Terrain {
 public:
  explicit RigidTerrain(HeightField surface) : surface_(std::move(surface)) {}

  const HeightField& surface() const override { return surface_; }
  bool is_deformable() const override { return false; }
  BedBounds bounds() const override { return bounds_of(surface_); }
  const HeightField* hard_surface() const override { return &surface_; }
  FootprintShape footprint_shape() const override { return FootprintShape::kNone; }
  void press(const PressingBody& /*body*/, std::span<FootprintContact> /*contacts*/, double /*dt*/,
             BodyMemory& /*memory*/) override {}
  void end_step(double /*dt*/) override {}
  /// Bodies stand on it with explicit springs (running_gear.h): at 2 ms a robot turns off its way.
  double longest_step_s() const override { return 0.001; }

 private:
  HeightField surface_;
};

}  // namespace screed
