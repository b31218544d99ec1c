// The slip watch in seeded drives of the firmware, with and without traps: a small part of what
// `screed nn stuck` drives. Rigid ground alone, which is quick.
#include <gtest/gtest.h>

#include <vector>

#include "nn/slip/stuck_run.h"
#include "nn/slip/stuck_scenario.h"

namespace screed::nn {
namespace {

/// The first seeds whose ground is rigid.
std::vector<StuckScenario> on_rigid_ground(bool trapped, std::size_t count, double duration_s) {
  std::vector<StuckScenario> all;
  for (std::uint64_t seed = 1; all.size() < count; ++seed) {
    StuckScenario scenario = stuck_scenario(seed, trapped, duration_s);
    if (scenario.ground == "rigid") all.push_back(std::move(scenario));
  }
  return all;
}

TEST(Stuck, DugInTracksAreDetectedWithinASecond) {
  int dug_in = 0;
  int detected = 0;
  for (const StuckScenario& scenario : on_rigid_ground(true, 8, 12.0)) {
    const SlipRun run = drive(scenario);
    ASSERT_TRUE(run.failure.empty()) << run.failure;
    const auto begin = dug_in_at(run);
    if (!begin) continue;
    ++dug_in;
    detected += detection_of(run, *begin).detected ? 1 : 0;
  }
  EXPECT_GE(dug_in, 3);
  EXPECT_GE(detected * 10, dug_in * 8) << detected << " of " << dug_in;
}

TEST(Stuck, FreeDrivesRaiseNoAlarm) {
  double driven_s = 0.0;
  int alarms = 0;
  for (const StuckScenario& scenario : on_rigid_ground(false, 6, 30.0)) {
    const FreeResult result = alarms_of(drive(scenario));
    driven_s += result.driven_s;
    alarms += result.false_alarms + result.recovered_alarms + result.other_alarms;
  }
  EXPECT_GT(driven_s, 120.0);
  EXPECT_EQ(alarms, 0);
}

TEST(Stuck, TheSameSeedIsTheSameDrive) {
  const StuckScenario scenario = on_rigid_ground(true, 1, 6.0).front();
  const SlipRun once = drive(scenario);
  const SlipRun again = drive_all({scenario, scenario}, 2).back();
  ASSERT_EQ(once.ticks.size(), again.ticks.size());
  for (std::size_t i = 0; i < once.ticks.size(); ++i) {
    ASSERT_EQ(once.ticks[i].inputs, again.ticks[i].inputs) << i;
    ASSERT_EQ(once.ticks[i].speed, again.ticks[i].speed) << i;
  }
  EXPECT_NE(stuck_scenario(2, true, 6.0).experiment.text(), scenario.experiment.text());
}

}  // namespace
}  // namespace screed::nn
