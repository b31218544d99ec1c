// How often a run tells how far it has come.
#include "host_sim/run/simulation/progress.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/unit/host_sim/run/rover5_plant.h"

namespace screed {
namespace {

struct Told {
  /// So many ticks of a run of `duration_s` on this ground, which was half flat before.
  Told(double duration_s, int ticks, const Environment& plant) {
    Experiment experiment;
    experiment.experiment.duration_s = duration_s;
    StopCondition stop(experiment, nullptr);
    HeightField half(5, 2, 0.1, false);
    for (int iy : {0, 1}) {
      half.set_node(3, iy, 1 << 20);
      half.set_node(4, iy, 1 << 21);
    }
    Progress progress([this](const SimulationProgress& one) { all.push_back(one); },
                      TerrainMeasure(experiment), half);
    for (int tick = 1; tick <= ticks; ++tick) {
      stop.count_tick(RobotState::kRunning, message::LevelingState::kWalk);
      progress.on_tick(stop, tick * 0.01, plant);
    }
  }

  std::vector<SimulationProgress> all;
};

TEST(Progress, TellsTenTimesASecondAndAtTheEnd) {
  const Plant rigid(HeightField::flat(2.0, 0.05), rover5(), held_at(0.0, 0.0));
  const Told told(0.25, 25, rigid);
  ASSERT_EQ(told.all.size(), 3U);
  EXPECT_DOUBLE_EQ(told.all[0].time_s, 0.1);
  EXPECT_DOUBLE_EQ(told.all[1].time_s, 0.2);
  EXPECT_DOUBLE_EQ(told.all[2].time_s, 0.25);
  EXPECT_DOUBLE_EQ(told.all[2].duration_s, 0.25);
}

TEST(Progress, LooksAtLooseGroundEveryFiveSeconds) {
  const Plant soil(HeightField::flat(2.0, 0.05), rover5(), on_soil(held_at(0.0, 0.0)));
  const Told told(6.0, 510, soil);
  ASSERT_EQ(told.all.size(), 51U);
  EXPECT_DOUBLE_EQ(told.all[48].flatness, 0.5);
  EXPECT_DOUBLE_EQ(told.all[49].flatness, 1.0);
  EXPECT_DOUBLE_EQ(told.all[50].flatness, 1.0);
}

TEST(Progress, RigidGroundStaysAsItWas) {
  const Plant rigid(HeightField::flat(2.0, 0.05), rover5(), held_at(0.0, 0.0));
  EXPECT_DOUBLE_EQ(Told(6.0, 510, rigid).all.back().flatness, 0.5);
}

}  // namespace
}  // namespace screed
