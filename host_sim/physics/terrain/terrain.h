// What every ground is to those who stand on it, record it or draw it.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "host_sim/physics/terrain/footprint_contact.h"
#include "host_sim/physics/terrain/height_field.h"

namespace screed {

// The particles of a bed as plain data, for those who record or draw them.

/// Equal spheres; none on terrain that is not made of them.
struct SphereSet {
  double radius_m = 0.0;
  std::vector<std::array<float, 3>> centers_m;  ///< x, y, z in the world
};

// What robots drive on, whatever it is made of: rigid ground (rigid_terrain.h), deformable soil,
// beds of particles. Plant and vehicle know this contract alone.
//
// A body meets terrain in two ways, and each terrain says which of them it has:
// - point by point on a hard surface, a height field that never deforms. The bodies keep the state
//   of their points (a belt carries its bristles along) and compute these forces themselves.
// - with its footprints (footprint_contact.h), in press(): one call a body and step, never one a
//   point.

/// What a body lays against a terrain in press().
enum class FootprintShape : uint8_t {
  kNone,          ///< nothing: the terrain has its hard surface alone
  kLowerSurface,  ///< the lower surface of running gear (a track of links as one band) and hull
  kSolid,         ///< whole solids that are touched from any side, every link of a track its own
};

/// A rectangle round (0, 0) of the world.
struct BedBounds {
  double width_m;  ///< west to east
  double depth_m;  ///< south to north
  BedEdge edge;
};

/// A height field's own.
inline BedBounds bounds_of(const HeightField& field) {
  return {field.x_max() - field.x_min(), field.y_max() - field.y_min(), field.edge()};
}

/// Volumes in height units of one cell (kHeightUnit_m spacing^2). Always: now = before - compacted
/// - in_transit. All zero for rigid terrain and particles.
struct VolumeBalance {
  int64_t before = 0;
  int64_t now = 0;
  int64_t compacted = 0;
  int64_t in_transit = 0;  ///< sunk in the last steps and not yet deposited
  int64_t error() const { return before - compacted - in_transit - now; }
};

/// What stepping has cost, in numbers that do not depend on a clock: for tests and benchmarks. All
/// zero on terrain that is not made of discrete elements.
struct TerrainWork {
  size_t elements = 0;
  size_t awake = 0;     ///< elements that moved in the last step
  size_t contacts = 0;  ///< pairs near enough to be looked at in the last step
  uint64_t steps = 0;
  uint64_t element_steps = 0;  ///< sum of `awake` over all steps
};

/// One contact between an element of the terrain and a solid: a spring and a damper side by side.
struct ContactStiffness {
  double stiffness_n_per_m = 0.0;
  double damping_n_s_per_m = 0.0;
};

class Terrain {
 public:
  virtual ~Terrain() = default;

  /// The surface as it is now, for those who look at it.
  virtual const HeightField& surface() const = 0;
  /// Whether the terrain deforms.
  virtual bool is_deformable() const = 0;
  virtual BedBounds bounds() const = 0;

  /// What never deforms: bodies stand on it point by point. Null: nothing does.
  virtual const HeightField* hard_surface() const { return nullptr; }
  /// What press() wants to be given.
  virtual FootprintShape footprint_shape() const = 0;
  /// No press() force acts above this height within `radius` of (x, y), m.
  virtual double max_height_within(double /*x*/, double /*y*/, double /*radius*/) const {
    return std::numeric_limits<double>::infinity();
  }
  /// A body in this step with all its footprints; fills in their reactions. `memory` is kept by the
  /// body from step to step. Every body of a step before end_step().
  virtual void press(const PressingBody& body, std::span<FootprintContact> contacts, double dt,
                     BodyMemory& memory) = 0;
  /// Of one contact with FootprintShape::kSolid, for a body that takes its reaction implicitly.
  virtual ContactStiffness contact_stiffness() const { return {}; }

  /// The terrain's own motion in a step, after all bodies.
  virtual void end_step(double dt) = 0;
  /// Longer steps diverge, s: whoever wants them divides them.
  virtual double longest_step_s() const { return std::numeric_limits<double>::infinity(); }

  virtual VolumeBalance balance() const { return {}; }
  virtual TerrainWork work() const { return {}; }
  /// Where its particles are; none on terrain without.
  virtual SphereSet spheres() const { return {}; }

 protected:
  Terrain() = default;
  Terrain(const Terrain&) = default;
  Terrain& operator=(const Terrain&) = default;
};

}  // namespace screed
