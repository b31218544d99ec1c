// A bed of particles: what computes it, and what it reports while it is made.
#include <gtest/gtest.h>
#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/lanes/instruction_set.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/particles/thread_team.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/world/plant.h"
#include "paths.h"
#include "tests/unit/allocations.h"
#include "tests/unit/host_sim/physics/particles/test_bed.h"

namespace screed {

namespace {

// What computes a bed: kernels, threads. (That each gives the same bits: tests/long.)

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

TEST(ThreadTeam, ThrowsOnWhatWorkThrowsAndGoesOn) {
  for (const int threads : {1, 2, 4}) {
    ThreadTeam team(threads);
    EXPECT_THROW(team.run(100,
                          [](size_t i, size_t /*member*/) {
                            if (i % 7 == 3) throw std::bad_alloc();
                          }),
                 std::bad_alloc);
    std::atomic<int> done = 0;
    team.run(100, [&](size_t /*i*/, size_t /*member*/) { ++done; });
    EXPECT_EQ(done, 100);
  }
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

// What a bed of particles reports while it is made, and that it can be stopped there.

using Reports = std::vector<std::pair<std::string, double>>;

/// 24 x 24 stacks of 4.
HeightField surface() {
  return HeightField::from_function(9, 9, 0.075, false, [](double, double) { return 0.1; });
}

/// Notes every report; stops at the one of that number.
TaskProgress note(Reports& reports, size_t stop_at = SIZE_MAX) {
  return [&reports, stop_at](std::string_view task, double share) {
    reports.emplace_back(task, share);
    if (reports.size() == stop_at) throw TaskStopped(task);
  };
}

/// The tasks in their order, each once.
std::vector<std::string> tasks_of(const Reports& reports) {
  std::vector<std::string> tasks;
  for (const auto& [task, share] : reports) {
    if (tasks.empty() || tasks.back() != task) tasks.push_back(task);
  }
  return tasks;
}

void expect_rising(const Reports& reports) {
  for (size_t i = 0; i < reports.size(); ++i) {
    const auto& [task, share] = reports[i];
    EXPECT_GE(share, 0.0) << task;
    EXPECT_LE(share, 1.0) << task;
    if (i > 0 && reports[i - 1].first == task) {
      EXPECT_GE(share, reports[i - 1].second) << task << ", report " << i;
    }
  }
}

TEST(ParticleProgress, LayingAndSettlingReportRisingShares) {
  Reports reports;
  const ParticleBed bed(surface(), {}, note(reports));
  EXPECT_EQ(tasks_of(reports),
            (std::vector<std::string>{"laying particles", "settling particles"}));
  expect_rising(reports);
  double laid = 0.0;
  for (const auto& [task, share] : reports) {
    if (task == "laying particles") laid = share;
  }
  EXPECT_GT(laid, 0.9);
  EXPECT_GT(reports.back().second, 0.5);
}

TEST(ParticleProgress, NobodyWhoListensChangesTheBed) {
  Reports reports;
  const ParticleBed watched(surface(), {}, note(reports));
  const ParticleBed alone(surface(), {});
  ASSERT_EQ(watched.size(), alone.size());
  for (size_t i = 0; i < alone.size(); ++i) ASSERT_EQ(watched.position(i), alone.position(i)) << i;
}

TEST(ParticleProgress, EndsWhereTheListenerThrows) {
  Reports all;
  const ParticleBed bed(surface(), {}, note(all));
  size_t settling = 0;
  while (all[settling].first != "settling particles") ++settling;
  for (const size_t stop_at : {size_t{1}, size_t{3}, settling + 2}) {
    Reports reports;
    try {
      const ParticleBed stopped(surface(), {}, note(reports, stop_at));
      FAIL() << "not stopped at report " << stop_at;
    } catch (const TaskStopped& stopped) {
      EXPECT_EQ(stopped.what(), all[stop_at - 1].first);
    }
    EXPECT_EQ(reports.size(), stop_at);
  }
}

TEST(ParticleProgress, ARobotThatSettlesReportsToo) {
  const Assembly robot = import_urdf(std::string(kBoardsFolder) + "/a_star_32u4/rover5.urdf");
  PlantOptions options;
  options.particles.emplace();
  Reports reports;
  options.progress = note(reports);
  const Plant plant(surface(), robot, options);
  EXPECT_EQ(tasks_of(reports), (std::vector<std::string>{"laying particles", "settling particles",
                                                         "settling the robot"}));
  expect_rising(reports);
  const size_t last = reports.size();
  reports.clear();
  options.progress = note(reports, last - 1);
  EXPECT_THROW(Plant(surface(), robot, options), TaskStopped);
}

}  // namespace

}  // namespace screed
