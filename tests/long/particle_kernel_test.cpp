// A bed of particles gives the same bits whatever computes it: every kernel of this processor, one
// thread or several.
// Long: eighteen runs, with all that can happen to a particle.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <string>

#include "host_sim/core/lanes/instruction_set.h"
#include "host_sim/physics/particles/bed_particles.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/footprint_contact.h"
#include "tests/unit/host_sim/physics/particles/test_bed.h"

namespace screed {
namespace {

/// Settles in part, is thrown about, and has a wheel roll over it: contacts that stick, slip, open,
/// sleep and wake.
std::string eventful(const ParticleOptions& options, bool periodic) {
  ParticleBed bed = fresh_heap(options, periodic);
  EXPECT_GT(bed.size(), 2 * kGroupParticles);
  const double dt = bed.longest_step_s();
  bed.settle(0.15);
  EXPECT_LT(bed.work().awake, bed.size());
  for (size_t i = 0; i < bed.size(); i += 13) {
    const double share = static_cast<double>(i % 7) / 7.0;
    bed.set_motion(i, {0.3 * share, 0.2 - 0.3 * share, 0.4 * share}, {0.0, 20.0 * share, 5.0});
  }
  for (int i = 0; i < 100; ++i) bed.step(dt);
  Footprint wheel = Footprint::wheel(0.04, 0.03);
  FootprintMotion motion;
  motion.velocity = {0.3, 0.0, 0.0};
  motion.surface_speed = 0.5;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() << -0.1, 0.0, 0.22;
  for (int i = 0; i < 100; ++i) {
    pose.translation() += dt * motion.velocity;
    wheel.set_pose(pose);
    bed.press(wheel, motion, dt);
    bed.step(dt);
  }
  EXPECT_GT(bed.work().awake, 0U);
  return fingerprint(bed);
}

// The expected values are of no meaning but that everything gives them.
TEST(ParticleKernel, AllKernelsAndNumbersOfThreadsGiveTheSameBits) {
  const char* const expected[] = {"10df1e03a4135668fc452fe9e237b422",
                                  "c1b4c9a62d2af1eebc5171ecbbcc2060"};
  for (const bool periodic : {false, true}) {
    for (const InstructionSet set : instruction_sets()) {
      for (const int threads : {1, 2, 3}) {
        ParticleOptions options;
        options.instructions = set;
        options.threads = threads;
        EXPECT_EQ(eventful(options, periodic), expected[periodic ? 1 : 0])
            << name_of(set) << ", " << threads << " threads";
      }
    }
  }
}

}  // namespace
}  // namespace screed
