// Comparison of a campaign's cells: small tables whose figures are known.
#include "host_sim/campaign/cell_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

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

}  // namespace
}  // namespace screed
