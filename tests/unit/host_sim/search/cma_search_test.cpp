// CMA-ES as questions and answers: it finds the lowest place, and the same one each time.
#include "host_sim/search/cma_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace screed {
namespace {

using Points = std::vector<std::vector<double>>;

/// A valley a hundred times steeper across than along, lowest at (0.6, 0.3, 0.9).
double valley(const std::vector<double>& point) {
  const double along = point[0] - 0.6 + point[1] - 0.3;
  const double across = point[0] - 0.6 - (point[1] - 0.3);
  const double further = point[2] - 0.9;
  return along * along + 100.0 * across * across + further * further;
}

/// The lowest value of the last of so many generations.
double lowest_after(int generations, const CmaSearch::Options& options) {
  CmaSearch search({0.2, 0.8, 0.5}, options);
  double lowest = 0.0;
  for (int i = 0; i < generations; ++i) {
    std::vector<double> values;
    for (const std::vector<double>& point : search.ask()) values.push_back(valley(point));
    lowest = *std::min_element(values.begin(), values.end());
    search.tell(values);
  }
  return lowest;
}

TEST(CmaSearch, FindsTheLowestPlaceOfASkewValley) {
  for (const std::uint32_t seed : {1U, 2U, 3U}) {
    EXPECT_GT(lowest_after(1, {12, 0.25, seed}), 1e-3) << seed;
    EXPECT_LT(lowest_after(80, {12, 0.25, seed}), 1e-6) << seed;
  }
}

TEST(CmaSearch, AsksForTheSamePointsUntilItIsTold) {
  CmaSearch search({0.5, 0.5}, {6, 0.3, 7});
  const Points points = search.ask();
  ASSERT_EQ(points.size(), 6U);
  for (const std::vector<double>& point : points) {
    ASSERT_EQ(point.size(), 2U);
    for (const double component : point) {
      EXPECT_GE(component, 0.0);
      EXPECT_LE(component, 1.0);
    }
  }
  EXPECT_EQ(search.ask(), points);
  search.tell({6, 5, 4, 3, 2, 1});
  EXPECT_NE(search.ask(), points);

  CmaSearch other({0.5, 0.5}, {6, 0.3, 7});
  EXPECT_EQ(other.ask(), points) << "the same seed";
  other.tell({6, 5, 4, 3, 2, 1});
  EXPECT_EQ(other.ask(), search.ask());
  CmaSearch told_otherwise({0.5, 0.5}, {6, 0.3, 7});
  told_otherwise.tell({1, 2, 3, 4, 5, 6});
  EXPECT_NE(told_otherwise.ask(), search.ask());
  EXPECT_NE(CmaSearch({0.5, 0.5}, {6, 0.3, 8}).ask(), points) << "another seed";
}

TEST(CmaSearch, RefusesWhatIsNoSearch) {
  EXPECT_THROW(CmaSearch({}, {8, 0.2, 1}), std::invalid_argument);
  EXPECT_THROW(CmaSearch({0.5, 1.1}, {8, 0.2, 1}), std::invalid_argument);
  EXPECT_THROW(CmaSearch({0.5, std::numeric_limits<double>::quiet_NaN()}, {8, 0.2, 1}),
               std::invalid_argument);
  EXPECT_THROW(CmaSearch({0.5}, {4, 0.2, 1}), std::invalid_argument);
  EXPECT_THROW(CmaSearch({0.5}, {8, 0.0, 1}), std::invalid_argument);
  CmaSearch search({0.5, 0.5}, {5, 0.2, 1});
  EXPECT_THROW(search.tell({1, 2, 3, 4}), std::invalid_argument);
  EXPECT_THROW(search.tell({1, 2, 3, 4, std::numeric_limits<double>::infinity()}),
               std::invalid_argument);
}

}  // namespace
}  // namespace screed
