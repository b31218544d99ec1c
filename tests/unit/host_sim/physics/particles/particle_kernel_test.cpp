// What computes a bed: kernels, threads. (That each gives the same bits: tests/long.)
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <atomic>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/lanes/instruction_set.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/particles/thread_team.h"
#include "tests/unit/allocations.h"
#include "tests/unit/host_sim/physics/particles/test_bed.h"

namespace screed {
namespace {

TEST(ParticleKernel, TheFastestOfTheProcessorIsTheDefault) {
  EXPECT_EQ(instruction_sets().front(), InstructionSet::kBaseline);
  EXPECT_EQ(ParticleOptions{}.instructions, instruction_sets().back());
}

TEST(ParticleKernel, RefusesNumbersOfThreadsThatMakeNoSense) {
  for (const int threads : {0, -1, 65}) {
    ParticleOptions options;
    options.threads = threads;
    EXPECT_THROW(fresh_heap(options, false), InputError) << threads;
  }
}

// With everything awake, in two threads: lists have their room after some rounds.
TEST(ParticleKernel, SteppingWithAllAwakeAllocatesNothing) {
  ParticleOptions options;
  options.threads = 2;
  ParticleBed bed = fresh_heap(options, false);
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
