// A bed gives the same bits whatever computes it: every kernel of this processor, one thread or
// several.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/lanes/instruction_set.h"
#include "host_sim/physics/particles/bed_layout.h"
#include "host_sim/physics/particles/bed_particles.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/particles/thread_team.h"
#include "host_sim/physics/terrain/footprint.h"
#include "host_sim/physics/terrain/footprint_contact.h"
#include "host_sim/physics/terrain/height_field.h"
#include "tests/unit/allocations.h"
#include "tests/unit/host_sim/physics/particles/fingerprint.h"

namespace screed {
namespace {

/// 30 x 30 stacks of 5 to 9: several groups of particles, so that contacts cross from one to
/// another.
HeightField heap(bool periodic) {
  constexpr double kSize = 0.75;
  return HeightField::from_function(31, 31, kSize / 30.0, periodic, [](double x, double y) {
    return 0.13 + 0.1 * std::max(0.0, 1.0 - 8.0 * (x * x + y * y));
  });
}

/// As laid, all awake.
ParticleBed fresh(const ParticleOptions& options, bool periodic) {
  const HeightField top = heap(periodic);
  const double radius = options.material.radius_m;
  const BedExtent extent = bed_extent(top, radius);
  return {lay_spheres(stack_counts(top, extent, radius), extent, radius, 1), extent, 0.4, options};
}

/// Settles in part, is thrown about, and has a wheel roll over it: contacts that stick, slip, open,
/// sleep and wake.
std::string eventful(const ParticleOptions& options, bool periodic) {
  ParticleBed bed = fresh(options, periodic);
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
  const char* const expected[] = {"9a3287c9eeda1f00dc1109e90e7c4fdd",
                                  "64a58f924885a8e976965a05f2b667c7"};
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

TEST(ParticleKernel, TheFastestOfTheProcessorIsTheDefault) {
  EXPECT_EQ(instruction_sets().front(), InstructionSet::kBaseline);
  ParticleOptions options;
  EXPECT_EQ(options.instructions, instruction_sets().back());
  const std::string once = eventful(options, false);
  options.instructions = instruction_sets().back();
  EXPECT_EQ(eventful(options, false), once);
}

TEST(ParticleKernel, RefusesNumbersOfThreadsThatMakeNoSense) {
  for (const int threads : {0, -1, 65}) {
    ParticleOptions options;
    options.threads = threads;
    EXPECT_THROW(fresh(options, false), InputError) << threads;
  }
}

// With everything awake, in two threads: lists have their room after some rounds.
TEST(ParticleKernel, SteppingWithAllAwakeAllocatesNothing) {
  ParticleOptions options;
  options.threads = 2;
  ParticleBed bed = fresh(options, false);
  const double dt = bed.longest_step_s();
  const auto shaken = [&] {
    bed.wake_all();
    for (size_t i = 0; i < bed.size(); i += 5) {
      bed.set_motion(i, {0.1, 0.0, 0.1}, Eigen::Vector3d::Zero());
    }
    for (int i = 0; i < 50; ++i) bed.step(dt);
  };
  for (int round = 0; round < 6; ++round) shaken();
  const long before = testing::allocations();
  shaken();
  EXPECT_EQ(testing::allocations(), before);
  EXPECT_EQ(bed.work().elements, bed.size());
}

TEST(ThreadTeam, DoesEachPartOnce) {
  for (const int threads : {1, 2, 4}) {
    ThreadTeam team(threads);
    EXPECT_EQ(team.threads(), threads);
    std::vector<std::atomic<int>> times(1000);
    std::atomic<bool> known{true};
    for (size_t round = 0; round < 200; ++round) {
      const size_t parts = round * 5;
      team.run(parts, [&](size_t i, size_t member) {
        ++times[i];
        if (member >= static_cast<size_t>(threads)) known = false;
      });
    }
    EXPECT_TRUE(known);
    for (size_t i = 0; i < times.size(); ++i) {
      // In each round with more than i parts.
      const auto expected = static_cast<int>(i < 995 ? 199 - i / 5 : 0);
      ASSERT_EQ(times[i], expected) << i << ", " << threads << " threads";
    }
  }
}

}  // namespace
}  // namespace screed
