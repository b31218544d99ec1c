// What a campaign says of a metric: comparison of cells and curves over time, of small tables whose
// figures are known.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "host_sim/campaign/cell_statistics.h"
#include "host_sim/core/statistics.h"

namespace screed {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// Three cells, five seeds: the second is 1 above the first in each, the third lies apart in two.
MetricValues table() {
  return {{10, 20, 30, 40, 50,  //
           11, 21, 31, 41, 51,  //
           12, 18, kNone, 46, 48},
          5};
}

TEST(CellComparison, MeansAreThoseOfTheCell) {
  const auto cells = compare_cells(table(), 0);
  ASSERT_EQ(cells.size(), 3U);
  EXPECT_EQ(cells[0].value.count, 5U);
  EXPECT_EQ(cells[0].value.mean, 30.0);
  EXPECT_LT(cells[0].value.interval.low, 22.0);
  EXPECT_EQ(cells[2].value.count, 4U);
  EXPECT_EQ(cells[2].value.mean, 31.0);
}

TEST(CellComparison, DifferencesAreTakenSeedBySeed) {
  const auto cells = compare_cells(table(), 0);
  EXPECT_FALSE(cells[0].against_baseline.has_value());
  const PairedDifference& second = cells[1].against_baseline.value();
  EXPECT_EQ(second.difference.mean, 1.0);
  EXPECT_EQ(second.difference.interval.low, 1.0) << "the spread between seeds is none of it";
  EXPECT_EQ(second.test.effect, 1.0);
  EXPECT_EQ(second.test.p, 2.0 / 32.0);
  EXPECT_EQ(second.p_holm, 2.0 * 2.0 / 32.0) << "two cells are compared";
  const PairedDifference& third = cells[2].against_baseline.value();
  EXPECT_EQ(third.difference.count, 4U) << "the seed without a value leaves its pair out";
  EXPECT_EQ(third.difference.mean, (2.0 - 2.0 + 6.0 - 2.0) / 4.0);
}

TEST(CellComparison, AnyCellMayBeTheBaseline) {
  const auto cells = compare_cells(table(), 1);
  EXPECT_EQ(cells[0].against_baseline.value().difference.mean, -1.0);
  EXPECT_FALSE(cells[1].against_baseline.has_value());
}

TEST(CellComparison, RanksAreOverSeedsThatAllCellsHave) {
  const auto cells = compare_cells(table(), 0);
  // Seeds 1, 2, 4, 5: 1 2 3, 2 3 1, 1 2 3, 2 3 1.
  EXPECT_EQ(cells[0].rank.value().mean, 1.5);
  EXPECT_EQ(cells[1].rank.value().mean, 2.5);
  EXPECT_EQ(cells[2].rank.value().mean, 2.0);
  EXPECT_FALSE(compare_cells({{1.0, kNone}, 1}, 0)[0].rank.has_value());
}

TEST(CellComparison, LevelsOfAFactorAreAveragedSeedBySeed) {
  const std::vector<std::vector<std::string>> cells = {
      {"gravel", "1"}, {"viper", "1"}, {"gravel", "2"}};
  const auto soils = levels_of(cells, 0);
  ASSERT_EQ(soils.size(), 2U);
  EXPECT_EQ(soils[0].value, "gravel");
  EXPECT_EQ(soils[0].cells, (std::vector<std::size_t>{0, 2}));
  EXPECT_EQ(soils[1].cells, (std::vector<std::size_t>{1}));
  const SeedMean gravel = mean_over_cells(table(), soils[0].cells);
  EXPECT_EQ(gravel.count, 5U);
  EXPECT_EQ(gravel.mean, (11.0 + 19.0 + 30.0 + 43.0 + 49.0) / 5.0);
  EXPECT_EQ(mean_over_cells({{kNone, kNone}, 2}, {0}).count, 0U);
}

TEST(CellComparison, ATableHasAValueARun) {
  EXPECT_THROW(MetricValues({1.0, 2.0, 3.0}, 2), std::logic_error);
  EXPECT_THROW(MetricValues({}, 0), std::logic_error);
}

/// Two cells with three seeds each.
CampaignPlan two_cells() {
  CampaignPlan plan;
  plan.cells = {{"a"}, {"b"}};
  plan.settings.seeds = {1, 2, 3};
  plan.ids = {"0", "1", "2", "3", "4", "5"};
  return plan;
}

class Points {
 public:
  Points& add(int run, double time_s, TableValue relief, TableValue progress = nullptr) {
    table.add_row();
    table.set("run", run);
    table.set("time", time_s);
    table.set("relief", std::move(relief));
    table.set("progress", std::move(progress));
    return *this;
  }
  ValueTable table;
};

CellCurve named(const std::vector<CellCurve>& curves, const std::string& name) {
  for (const CellCurve& curve : curves) {
    if (curve.name == name) return curve;
  }
  throw std::out_of_range(name);
}

TEST(CellCurves, MeansAreOverTheSeedsOfACellAtEachTime) {
  Points points;
  const double relief[3][2] = {{8.0, 4.0}, {6.0, 5.0}, {10.0, 9.0}};
  for (int run = 0; run < 6; ++run) {
    for (int at = 0; at < 2; ++at)
      points.add(run, 60.0 * at, relief[run % 3][at] + (run < 3 ? 0.0 : 100.0));
  }
  const auto curves = cell_curves(two_cells(), points.table);
  const CellCurve curve = named(curves, "relief");
  EXPECT_EQ(curve.times_s, (std::vector<double>{0.0, 60.0}));
  ASSERT_EQ(curve.cells.size(), 2U);
  EXPECT_EQ(curve.cells[0][0].mean, 8.0);
  EXPECT_EQ(curve.cells[0][1].mean, 6.0);
  EXPECT_EQ(curve.cells[1][1].mean, 106.0);
  EXPECT_EQ(curve.cells[0][1].count, 3U);
  const Interval interval = bootstrap_mean_interval({4.0, 5.0, 9.0});
  EXPECT_EQ(curve.cells[0][1].interval.low, interval.low);
  EXPECT_EQ(curve.cells[0][1].interval.high, interval.high);
}

TEST(CellCurves, ARunThatEndedBeforeKeepsItsLastValue) {
  Points points;
  points.add(0, 0.0, 8.0).add(0, 60.0, 7.0).add(0, 120.0, 6.0);
  points.add(1, 0.0, 8.0).add(1, 31.0, 2.0);  // a fault
  points.add(2, 0.0, 8.0).add(2, 60.0, 7.0).add(2, 120.0, 7.0);
  const CellCurve curve = named(cell_curves(two_cells(), points.table), "relief");
  EXPECT_EQ(curve.times_s, (std::vector<double>{0.0, 31.0, 60.0, 120.0}));
  EXPECT_EQ(curve.cells[0][1].mean, (8.0 + 2.0 + 8.0) / 3.0);
  EXPECT_EQ(curve.cells[0][3].mean, 5.0);
  EXPECT_EQ(curve.cells[0][3].count, 3U);
  EXPECT_EQ(curve.cells[1][3].count, 0U) << "no run of this cell";
}

TEST(CellCurves, AFigureThatIsMeasuredMoreSeldomHasItsOwnTimes) {
  Points points;
  for (int run = 0; run < 6; ++run)
    points.add(run, 0.0, 8.0, 0.0).add(run, 10.0, 8.0).add(run, 20.0, 8.0, 0.5);
  const auto curves = cell_curves(two_cells(), points.table);
  EXPECT_EQ(named(curves, "relief").times_s.size(), 3U);
  EXPECT_EQ(named(curves, "progress").times_s, (std::vector<double>{0.0, 20.0}));
}

TEST(CellCurves, LongCurvesAreThinnedAndKeepTheirEnds) {
  Points points;
  for (int at = 0; at <= 1000; ++at) points.add(0, at, 1.0 + at);
  const CellCurve curve = named(cell_curves(two_cells(), points.table), "relief");
  ASSERT_EQ(curve.times_s.size(), kMaxCurveTimes);
  EXPECT_EQ(curve.times_s.front(), 0.0);
  EXPECT_EQ(curve.times_s.back(), 1000.0);
  EXPECT_EQ(curve.cells[0].back().mean, 1001.0);
}

TEST(CellCurves, ThereAreNoneWhereNoneWereKeptOrMeasured) {
  EXPECT_TRUE(cell_curves(two_cells(), ValueTable()).empty());
  Points points;
  points.add(0, 0.0, nullptr).add(0, 10.0, nullptr);
  EXPECT_TRUE(cell_curves(two_cells(), points.table).empty());
}

}  // namespace
}  // namespace screed
