// What a bed of particles reports while it is made, and that it can be stopped there.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host_sim/core/task_progress.h"
#include "host_sim/physics/particles/particle_bed.h"
#include "host_sim/physics/vehicle/urdf/urdf_importer.h"
#include "host_sim/physics/world/plant.h"
#include "paths.h"

namespace screed {
namespace {

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
