// The slip watch in seeded drives of the firmware, with and without traps: a small part of what
// `screed nn stuck` drives. Rigid ground alone, which is quick.
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <vector>

#include "firmware/robot/robot.h"
#include "host_sim/run/world/world.h"
#include "host_sim/run/world/world_setup.h"
#include "nn/slip/slip_campaign.h"
#include "tests/temp_folder.h"

namespace screed::nn {
namespace {

/// The first seeds whose ground is rigid.
std::vector<StuckScenario> on_rigid_ground(ScenarioKind kind, std::size_t count,
                                           double duration_s) {
  std::vector<StuckScenario> all;
  for (std::uint64_t seed = 1; all.size() < count; ++seed) {
    StuckScenario scenario = stuck_scenario(seed, kind, duration_s);
    if (scenario.ground == "rigid") all.push_back(std::move(scenario));
  }
  return all;
}

TEST(Stuck, DugInTracksAreDetectedWithinASecond) {
  const SlipFigures figures =
      figures_of(drive_all(on_rigid_ground(ScenarioKind::kTrapped, 8, 12.0), 1));
  EXPECT_EQ(figures.failures, 0);
  EXPECT_GE(figures.all.dug_in, 3);
  EXPECT_GE(figures.all.detected * 10, figures.all.dug_in * 8)
      << figures.all.detected << " of " << figures.all.dug_in;
}

TEST(Stuck, FreeDrivesRaiseNoAlarmAndTravelAsTheirTracksDo) {
  const SlipFigures figures =
      figures_of(drive_all(on_rigid_ground(ScenarioKind::kFree, 6, 30.0), 1));
  EXPECT_GT(figures.all.driven_s, 120.0);
  EXPECT_EQ(figures.all.false_alarms + figures.all.recovered_alarms + figures.all.other_alarms, 0);
  EXPECT_LT(figures.share.rms(), 0.1);
}

TEST(Stuck, TheSameSeedIsTheSameDriveAndAKeptOneIsReadAgain) {
  const TempFolder folder;
  const StuckScenario scenario = on_rigid_ground(ScenarioKind::kTrapped, 1, 6.0).front();
  const SlipDrive once = drive(scenario);
  const SlipDrive again = drive_all({scenario, scenario}, 2).back();
  const SlipDrive kept = drive_all({scenario}, 1, {}, folder.path()).front();
  const SlipDrive read = drive_all({scenario}, 1, {}, folder.path()).front();
  ASSERT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  for (const SlipDrive* other : {&again, &kept, &read}) {
    ASSERT_EQ(once.ticks.size(), other->ticks.size());
    for (std::size_t i = 0; i < once.ticks.size(); ++i) {
      ASSERT_EQ(once.ticks[i].gyro, other->ticks[i].gyro) << i;
      ASSERT_EQ(once.ticks[i].effort_left, other->ticks[i].effort_left) << i;
      ASSERT_EQ(once.ticks[i].speed, other->ticks[i].speed) << i;
    }
  }
  EXPECT_NE(stuck_scenario(2, ScenarioKind::kTrapped, 6.0).experiment.text(),
            scenario.experiment.text());
}

TEST(Stuck, AReplayedWatchSaysWhatTheRobotsOwnSaid) {
  const StuckScenario scenario = on_rigid_ground(ScenarioKind::kTrapped, 1, 12.0).front();
  const SlipDrive recorded = drive(scenario);
  const Experiment& e = scenario.experiment;
  const std::unique_ptr<World> world = make_world(e);
  int different = 0;
  int known = 0;  // ticks with a share of travel
  replay(recorded, [&](std::size_t /*tick*/, const SlipWatch& watch, const ReplayedTick& /*what*/) {
    world->advance();
    const SlipWatch& own = world->firmware().slip_watch();
    different += watch.evidence() != own.evidence() || watch.travel_share() != own.travel_share();
    known += watch.travel_share() != 255 ? 1 : 0;
  });
  EXPECT_EQ(different, 0);
  EXPECT_GT(known, 100);
}

}  // namespace
}  // namespace screed::nn
