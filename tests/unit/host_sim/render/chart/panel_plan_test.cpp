// Which series of a plot share a panel.
#include "host_sim/render/chart/panel_plan.h"

#include <gtest/gtest.h>

#include <vector>

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

}  // namespace
}  // namespace screed
