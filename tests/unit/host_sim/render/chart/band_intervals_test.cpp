// States over time as intervals.
#include "host_sim/render/chart/band_intervals.h"

#include <gtest/gtest.h>

#include <vector>

namespace screed {
namespace {

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
