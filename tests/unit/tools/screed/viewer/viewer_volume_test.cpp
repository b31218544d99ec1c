// The figures of the terrain beside the window are those of the run's summary: while it runs, and
// of its recording.
#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/simulation.h"
#include "tests/temp_folder.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"
#include "tools/screed/viewer/keyboard_driver.h"
#include "tools/screed/viewer/run_viewers.h"

namespace screed::viewer {
namespace {

class ViewerVolume : public ::testing::Test {
 protected:
  ViewerVolume() {
    options_.window = false;
    options_.shading = Shading::kChange;
    options_.screenshot = (folder_.path() / "p.png").string();
  }

  /// Of a robot that settles into soft soil and drives; `more`: lines of [map].
  Experiment on_soil(const std::string& more = "") const {
    write_text(folder_.path() / "e.ini",
               "[experiment]\nduration = 1\nalgorithm = hill_sensing\n[soil]\npreset = viper\n"
               "cell = 0.02\n[map]\nsize = 1\nmodel = scm\n" +
                   more);
    return read_experiment(folder_.path() / "e.ini");
  }

  std::pair<SimulationSummary, Status> watched(const Experiment& experiment, bool heights) {
    KeyboardDriver driver(ground_key_of(experiment),
                          algorithm_number(experiment.experiment.algorithm), nullptr);
    LiveViewer viewer(experiment, kDefaultBoard, options_, driver, [] {});
    SimulationOptions options;
    options.out = folder_.path() / "run";
    options.heights = heights;
    options.table = false;
    options.observer = &viewer;
    SimulationSummary summary = run_simulation(experiment, options);
    return {std::move(summary), viewer.status()};
  }
  Status replayed() const {
    RecordedViewer viewer(folder_.path() / "run", options_);
    viewer.run();
    return viewer.status();
  }

  static void expect_as(const SimulationSummary& summary, const Status& shown) {
    const TerrainOutcome& expected = summary.terrain;
    const TerrainChange& change = expected.change;
    EXPECT_GT(change.cut_m3, 0.0);
    ASSERT_TRUE(shown.terrain.volume.has_value());
    EXPECT_DOUBLE_EQ(shown.terrain.volume->moved_m3, change.moved_m3());
    EXPECT_DOUBLE_EQ(shown.terrain.volume->cut_m3, change.cut_m3);
    EXPECT_DOUBLE_EQ(shown.terrain.volume->fill_m3, change.fill_m3);
    EXPECT_DOUBLE_EQ(shown.terrain.volume->deepest_cut_m, change.deepest_cut_m);
    EXPECT_DOUBLE_EQ(shown.terrain.volume->deepest_fill_m, change.deepest_fill_m);
    EXPECT_NEAR(shown.terrain.before.mean_deg, expected.before.heights.mean_slope_deg, 0.005);
    EXPECT_NEAR(shown.terrain.now.mean_deg, expected.after.heights.mean_slope_deg, 0.005);
    ASSERT_TRUE(shown.leveling_before.has_value() && shown.leveling_now.has_value());
    EXPECT_EQ(shown.leveling_before->level_deviation_m,
              expected.before.robot_scale.level_deviation_m);
    EXPECT_EQ(shown.leveling_now->level_deviation_m, expected.after.robot_scale.level_deviation_m);
    EXPECT_EQ(shown.leveling_now->roughness_m, expected.after.robot_scale.roughness_m);
    EXPECT_EQ(shown.leveling_now->flat, expected.after.robot_scale.flatness);
    const double progress = summary.leveling.after.progress;
    EXPECT_EQ(shown.leveling_now->progress,
              std::isnan(progress) ? std::nullopt : std::optional(progress));
  }

  TempFolder folder_;
  ViewerOptions options_;
};

TEST_F(ViewerVolume, IsThatOfTheSummaryOnSoil) {
  const auto [summary, live] = watched(on_soil(), false);
  expect_as(summary, live);
  expect_as(summary, replayed());
}

TEST_F(ViewerVolume, IsThatOfTheSummaryWithRecordedHeights) {
  const auto [summary, live] = watched(on_soil(), true);
  expect_as(summary, live);
  const SessionReader session(folder_.path() / "run" / "session.h5");
  EXPECT_NE(session.heights_after(0).heights, session.terrain_before()->heights)
      << "the robot settles before the first tick";
  expect_as(summary, replayed());
}

TEST_F(ViewerVolume, TheProgressShownIsThatOfTheSummary) {
  const auto [summary, live] = watched(on_soil("ramp = 3\n"), false);
  EXPECT_NE(summary.leveling.after.progress, 0.0);
  ASSERT_TRUE(live.leveling_now.has_value());
  EXPECT_EQ(live.leveling_now->progress, summary.leveling.after.progress);
  EXPECT_EQ(live.leveling_before->progress, 0.0);
  const Status again = replayed();
  ASSERT_TRUE(again.leveling_now.has_value());
  EXPECT_EQ(again.leveling_now, live.leveling_now);
}

TEST_F(ViewerVolume, RecordedTerrainsOfDifferentGridsAreRefused) {
  Recording run;
  run.info.experiment_text = "[map]\nmodel = scm\n";
  run.frames.emplace_back();
  run.samples.emplace_back();
  run.outputs.emplace_back();
  run.before.geometry = {4, 3, kHeightUnit_m, 0.25, -0.375, -0.25, false};
  run.before.heights.assign(12, 0);
  run.after.geometry = {4, 4, kHeightUnit_m, 0.25, -0.375, -0.375, false};
  run.after.heights.assign(16, 0);
  write_run(folder_.path() / "session.h5", run);
  EXPECT_THROW(RecordedViewer(folder_.path(), options_), InputError);
}

}  // namespace
}  // namespace screed::viewer
