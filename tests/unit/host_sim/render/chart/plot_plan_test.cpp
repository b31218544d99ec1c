// Which series of a plot share a panel, and how long states are shown to have held.
#include <gtest/gtest.h>

#include <vector>

#include "host_sim/render/chart/plot_plan.h"

namespace screed {
namespace {

using Numbers = std::vector<std::size_t>;

TEST(PanelPlan, HasAPanelForEachUnitAndStatesAtTheTimeAxis) {
  const std::vector<SeriesKind> series = {{"deg", false}, {"", true}, {"mV", false},
                                          {"deg", false}, {"", true}, {"1", false}};
  const std::vector<PlannedPanel> panels = plan_panels(series);
  ASSERT_EQ(panels.size(), 4U);
  EXPECT_EQ(panels[0].unit, "deg");
  EXPECT_EQ(panels[0].series, (Numbers{0, 3}));
  EXPECT_EQ(panels[1].unit, "mV");
  EXPECT_EQ(panels[1].series, Numbers{2});
  EXPECT_EQ(panels[2].unit, "1");
  EXPECT_EQ(panels[2].series, Numbers{5});
  EXPECT_TRUE(panels[3].of_states);
  EXPECT_EQ(panels[3].series, (Numbers{1, 4}));
  for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(panels[i].of_states);
}

TEST(PanelPlan, SplitsAUnitEvenlyWhenItHasTooManyLines) {
  for (std::size_t count = 1; count < 40; ++count) {
    const std::vector<PlannedPanel> panels =
        plan_panels(std::vector<SeriesKind>(count, SeriesKind{"mm", false}));
    EXPECT_EQ(panels.size(), (count + kMaxPanelSeries - 1) / kMaxPanelSeries) << count;
    Numbers all;
    std::size_t least = count;
    std::size_t most = 0;
    for (const PlannedPanel& panel : panels) {
      EXPECT_EQ(panel.unit, "mm");
      least = std::min(least, panel.series.size());
      most = std::max(most, panel.series.size());
      all.insert(all.end(), panel.series.begin(), panel.series.end());
    }
    EXPECT_LE(most, kMaxPanelSeries) << count;
    EXPECT_LE(most - least, 1U) << count;
    ASSERT_EQ(all.size(), count);
    for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(all[i], i);
  }
}

TEST(PanelPlan, OfNothingIsNothing) {
  EXPECT_TRUE(plan_panels({}).empty());
}

using Points = std::vector<StatePoint>;
using Intervals = std::vector<BandInterval>;

TEST(BandIntervals, AValueHoldsUntilTheNextIsSeen) {
  const Points points = {{0.0, 1}, {0.2, 1}, {0.4, 3}, {0.6, 3}, {0.8, 1}};
  EXPECT_EQ(band_intervals(points, 0.2, 1.0, 9.0),
            (Intervals{{0.0, 0.4, 1}, {0.4, 0.8, 3}, {0.8, 1.0, 1}}));
}

TEST(BandIntervals, NothingIsKnownInAGap) {
  const Points points = {{0.0, 1}, {1.0, 1}, {5.0, 1}, {6.0, 2}};
  EXPECT_EQ(band_intervals(points, 0.5, 2.0, 9.0),
            (Intervals{{0.0, 1.5, 1}, {5.0, 6.0, 1}, {6.0, 6.5, 2}}));
  // A gap just as long as allowed is none.
  EXPECT_EQ(band_intervals(points, 0.5, 4.0, 9.0), (Intervals{{0.0, 6.0, 1}, {6.0, 6.5, 2}}));
}

TEST(BandIntervals, EventsAreMoments) {
  const Points points = {{1.0, 4}, {2.0, 4}, {3.0, 5}};
  EXPECT_EQ(band_intervals(points, 0.0, 0.0, 9.0),
            (Intervals{{1.0, 1.0, 4}, {2.0, 2.0, 4}, {3.0, 3.0, 5}}));
}

TEST(BandIntervals, NoneGoesBeyondTheEndOfTheData) {
  const Points points = {{0.0, 1}, {4.0, 1}, {5.0, 2}};
  EXPECT_EQ(band_intervals(points, 0.5, 2.0, 5.2),
            (Intervals{{0.0, 0.5, 1}, {4.0, 5.0, 1}, {5.0, 5.2, 2}}));
  EXPECT_EQ(band_intervals(points, 0.5, 2.0, 5.0).back(), (BandInterval{5.0, 5.0, 2}));
}

TEST(BandIntervals, OfNothingAreNone) {
  EXPECT_TRUE(band_intervals({}, 1.0, 1.0, 9.0).empty());
  EXPECT_EQ(band_intervals(Points{{2.0, 7}}, 0.25, 1.0, 9.0), (Intervals{{2.0, 2.25, 7}}));
}

}  // namespace
}  // namespace screed
