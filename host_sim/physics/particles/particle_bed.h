// A bed of equal spheres that a robot drives on: they push on each other, on walls and on running
// gear, most of them asleep.
//
// Only particles that move are computed. One that has stayed in its place for a while is put to
// sleep; it then stands as fixed as a wall, with the state of its contacts kept. It wakes when a
// neighbour has moved noticeably, when running gear moves against it or leaves it, or when a
// particle hits it. So the cost of a step follows what happens, not the size of the bed.
//
// The bed has a floor at height 0 and walls round it, or repeats (periodic). Everything is computed
// in a fixed order: the same bits on every compiler and any number of worlds side by side. Stepping
// allocates nothing once its lists have grown.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "host_sim/core/gravity.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/physics/particles/bed_layout.h"
#include "host_sim/physics/particles/sphere_grid.h"
#include "host_sim/physics/particles/sphere_law.h"
#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/footprint_contact.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/terrain.h"

namespace screed {

struct ParticleOptions {
  ParticleMaterial material;
  double ray_spacing_m = 0.005;  ///< of the rays that read the height map
  uint64_t seed = 1;             ///< of the layout
  bool fixed = false;            ///< particles never move: ground of spheres, as rigid as rock
  Eigen::Vector3d gravity = {0.0, 0.0, -kGravity_m_per_s2};
};

class ParticleBed final : public Terrain {
 public:
  /// Fills the space below `top` and lets it come to rest (unless fixed). Throws InputError as
  /// stack_counts, and for material out of range. Reports the tasks "laying particles" and
  /// "settling particles".
  ParticleBed(const HeightField& top, const ParticleOptions& options,
              const TaskProgress& progress = {});
  /// Particles at these positions, all awake, in a container of this extent and height.
  ParticleBed(const std::vector<Eigen::Vector3d>& centres, const BedExtent& extent, double height_m,
              const ParticleOptions& options);

  /// One footprint after the other; forces act on bodies and particles. Needs no memories.
  void press(const PressingBody& body, std::span<FootprintContact> contacts, double dt,
             BodyMemory& memory) override;
  /// A solid against the particles in this step. It is known by its address, which must not change.
  TerrainReaction press(const Footprint& solid, const FootprintMotion& motion, double dt);
  /// One step of at most longest_step_s().
  void step(double dt);
  void end_step(double dt) override { step(dt); }
  double longest_step_s() const override { return SphereLaw::longest_step_s(options_.material); }
  /// Steps until every particle sleeps, for at most this time; returns the time it took, s.
  double settle(double max_s, const TaskProgress& progress = {});

  /// The height map as it is now: under each ray the highest surface of a particle, or the floor.
  const HeightField& surface() const override;
  bool is_deformable() const override { return true; }
  BedBounds bounds() const override;
  /// The floor below the particles: level, at height 0, without end.
  const HeightField* hard_surface() const override { return &floor_; }
  FootprintShape footprint_shape() const override { return FootprintShape::kSolid; }
  ContactStiffness contact_stiffness() const override;

  const ParticleOptions& options() const { return options_; }
  const BedExtent& extent() const { return extent_; }
  TerrainWork work() const override { return work_; }
  SphereSet spheres() const override;
  size_t size() const { return position_.size(); }
  const Eigen::Vector3d& position(size_t particle) const { return position_[particle]; }
  const Eigen::Vector3d& velocity(size_t particle) const { return velocity_[particle]; }
  const Eigen::Vector3d& angular_velocity(size_t particle) const {
    return angular_velocity_[particle];
  }
  bool awake(size_t particle) const { return state_[particle] != kAsleep; }
  /// For experiments: gives a particle a motion and wakes it.
  void set_motion(size_t particle, const Eigen::Vector3d& velocity,
                  const Eigen::Vector3d& angular_velocity);
  /// Wakes all, as on a bed that has been shaken: none sleeps before it has rested anew.
  void wake_all();

 private:
  static constexpr int kSlots = 12;  // the kissing number; a particle keeps about half of its own
  static constexpr int32_t kNoPartner = -1;
  static constexpr int32_t kFloor = -2;  // kFloor - 1 .. kFloor - 4: the walls
  static constexpr int32_t kGear = -8;   // kGear - n: the n-th body that ever pressed

  enum State : uint8_t { kAsleep, kAwake };

  struct Slot {  // a contact that keeps its state
    int32_t partner = kNoPartner;
    ContactBristle bristle{};
  };
  struct ContactPair {
    int32_t a;  // the one that keeps the slot
    int32_t b;
    int32_t slot;  // or -1
  };

  void set_up();
  void wake(int32_t particle);
  void wake_near(int32_t particle);
  Slot* slot_of(int32_t particle, int32_t partner);
  Slot* take_slot(int32_t particle, int32_t partner);
  void find_pairs();
  void collide_pairs(double dt);
  void collide_walls(double dt);
  void collide_wall(int32_t particle, int32_t wall, const Eigen::Vector3d& normal, double distance,
                    double dt);
  void move(double dt);
  void release_gear();
  void mark(int32_t cell);
  void cast_rays(int column_x, int column_y) const;
  Eigen::Vector3d between(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;
  int32_t gear_number(const Footprint* solid);

  ParticleOptions options_;
  BedExtent extent_;
  SphereLaw law_;
  double mass_;
  double inertia_;
  double drag_ = 0.0;      // share of the speed lost in a second, while settling
  double window_s_ = 0.0;  // of rest before sleep
  SphereGrid grid_;
  TerrainWork work_;

  // Of each particle.
  std::vector<Eigen::Vector3d> position_;
  std::vector<Eigen::Vector3d> velocity_;
  std::vector<Eigen::Vector3d> angular_velocity_;
  std::vector<Eigen::Vector3d> force_;
  std::vector<Eigen::Vector3d> moment_;
  std::vector<Eigen::Vector3d> anchor_;  // where it was when it last woke its neighbours
  std::vector<double> rest_s_;           // how long it has been there
  std::vector<uint8_t> state_;
  std::vector<uint64_t> gear_step_;  // the last step in which running gear touched it
  std::vector<Slot> slots_;

  std::vector<int32_t> awake_;
  std::vector<ContactPair> pairs_;
  bool pairs_stale_ = true;
  double travelled_ = 0.0;            // of the fastest particle since the pairs were found, m
  std::vector<int32_t> pressed_;      // particles that gear touches in this step
  std::vector<int32_t> was_pressed_;  // and in the last
  std::vector<const Footprint*> gear_;
  uint64_t steps_ = 1;

  HeightField floor_{2, 2, 1.0, false};
  // The height map, and the columns of the grid in which it may be out of date.
  mutable HeightField surface_;
  mutable std::vector<uint8_t> stale_;
  mutable std::vector<int32_t> stale_columns_;
  mutable std::vector<uint8_t> to_cast_;
  mutable std::vector<int32_t> cast_columns_;
  std::vector<int> rays_x_;  // the first ray in each column of the grid, and one more
  std::vector<int> rays_y_;
};

}  // namespace screed
