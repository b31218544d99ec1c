// A bed of equal spheres that a robot drives on: they push on each other, on walls and on running
// gear, most of them asleep.
//
// Only particles that move are computed. One that has stayed in its place for a while is put to
// sleep; it then stands as fixed as a wall, with the state of its contacts kept. It wakes when a
// neighbour has moved noticeably, when running gear moves against it or leaves it, or when a
// particle hits it. So the cost of a step follows what happens, not the size of the bed.
//
// The bed has a floor at height 0 and walls round it, or repeats (periodic). Everything is computed
// in a fixed order: the same bits on every compiler, with every kernel, in any number of threads
// and of worlds side by side. Stepping allocates nothing once its lists have grown.
//
// The parts: bed_layout.h lays the particles, contact_groups.h keeps lists of who is awake and who
// touches whom, bed_kernel.h computes contacts and motion, bed_surface.h reads the height map.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host_sim/core/constants.h"
#include "host_sim/core/lanes/instruction_set.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/physics/particles/bed_kernel.h"
#include "host_sim/physics/particles/bed_kernels.h"
#include "host_sim/physics/particles/bed_layout.h"
#include "host_sim/physics/particles/bed_particles.h"
#include "host_sim/physics/particles/bed_surface.h"
#include "host_sim/physics/particles/contact_groups.h"
#include "host_sim/physics/particles/sphere_grid.h"
#include "host_sim/physics/particles/sphere_law.h"
#include "host_sim/physics/particles/thread_team.h"
#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/footprint_contact.h"
#include "host_sim/physics/terrain/height_field.h"
#include "host_sim/physics/terrain/terrain.h"

namespace screed {

constexpr int kMaxBedThreads = 64;

struct ParticleOptions {
  ParticleMaterial material;
  double ray_spacing_m = 0.005;  ///< of the rays that read the height map
  uint64_t seed = 1;             ///< of the layout
  bool fixed = false;            ///< particles never move: ground of spheres, as rigid as rock
  Eigen::Vector3d gravity = {0.0, 0.0, -kGravity_m_per_s2};
  // How it is computed; nothing that comes out depends on these.
  int threads = 1;  ///< 1 to kMaxBedThreads, that of the caller included
  InstructionSet instructions = instruction_sets().back();
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
  size_t size() const { return particles_.size; }
  Eigen::Vector3d position(size_t particle) const {
    return Eigen::Vector3d(particles_.place[particle].at);
  }
  Eigen::Vector3d velocity(size_t particle) const {
    return Eigen::Vector3d(particles_.motion[particle].velocity);
  }
  Eigen::Vector3d angular_velocity(size_t particle) const {
    return Eigen::Vector3d(particles_.motion[particle].spin);
  }
  bool awake(size_t particle) const { return particles_.awake(static_cast<int32_t>(particle)); }
  /// For experiments: gives a particle a motion and wakes it.
  void set_motion(size_t particle, const Eigen::Vector3d& velocity,
                  const Eigen::Vector3d& angular_velocity);
  /// Wakes all, as on a bed that has been shaken: none sleeps before it has rested anew.
  void wake_all();

 private:
  void wake(int32_t particle);
  void wake_near(int32_t particle);
  void set_constants(double dt);
  void compute_groups();
  BedRows rows(int32_t group, std::vector<PushRow>& pushes);
  void push_group(int32_t number, std::vector<PushRow>& pushes);
  void move_edge(int32_t number, std::vector<PushRow>& pushes);
  void follow_moved();
  void settle_rested();
  void release_gear();
  int32_t gear_partner(const Footprint* solid);

  ParticleOptions options_;
  BedExtent extent_;
  SphereLaw law_;
  BedFunctions kernel_;
  StepConstants constants_{};
  double drag_ = 0.0;  // share of the speed lost in a second, while settling
  double window_s_;    // of rest before sleep
  double now_s_ = 0.0;
  SphereGrid grid_;
  TerrainWork work_;

  BedParticles particles_;
  ContactStore store_;
  ContactGroups groups_;
  ThreadTeam team_;
  std::vector<std::vector<PushRow>> pushes_;  // of each thread; zero between groups
  double travelled_ = 0.0;  // of the fastest particle since it was found what touches, m

  std::vector<uint64_t> gear_step_;   // the last step in which running gear touched a particle
  std::vector<int32_t> pressed_;      // particles that gear touches in this step
  std::vector<int32_t> was_pressed_;  // and in the last
  std::vector<const Footprint*> gear_;
  uint64_t steps_ = 1;

  HeightField floor_{2, 2, 1.0, false};
  mutable BedSurface surface_;
};

}  // namespace screed
