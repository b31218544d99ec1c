// Lists, ranges and samples of campaign files.
#include "host_sim/campaign/campaign_values.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "host_sim/core/errors.h"

namespace screed {
namespace {

TEST(CampaignValues, SeedsAreListsAndRanges) {
  EXPECT_EQ(parse_seeds("7", "here"), (std::vector<uint64_t>{7}));
  EXPECT_EQ(parse_seeds("1..3, 10, 0..0", "here"), (std::vector<uint64_t>{1, 2, 3, 10, 0}));
  EXPECT_EQ(parse_seeds("18446744073709551614 .. 18446744073709551615", "here").size(), 2U);
}

TEST(CampaignValues, RefusesSeedsThatAreNone) {
  for (const char* text : {"", "x", "-1", "1..", "3..1", "1, 1", "1..5, 5", "1.5", "1...3",
                           "0..1000000", "0..18446744073709551615", "1,,2"}) {
    EXPECT_THROW(parse_seeds(text, "here"), InputError) << text;
  }
}

TEST(CampaignValues, RangesHaveTwoEnds) {
  const SampleRange plain = parse_range("-0.5..2e3", "here");
  EXPECT_EQ(plain.low, -0.5);
  EXPECT_EQ(plain.high, 2000.0);
  EXPECT_FALSE(plain.logarithmic);
  const SampleRange log = parse_range("0.001 .. 0.1 log", "here");
  EXPECT_EQ(log.low, 0.001);
  EXPECT_EQ(log.high, 0.1);
  EXPECT_TRUE(log.logarithmic);
}

TEST(CampaignValues, RefusesRangesThatAreNone) {
  for (const char* text :
       {"", "3", "1..", "..1", "2..1", "0..1 log", "-1..1 log", "1..2 lin", "a..b", "1..inf"}) {
    EXPECT_THROW(parse_range(text, "here"), InputError) << text;
  }
}

TEST(CampaignValues, ValuesSpanTheRange) {
  EXPECT_EQ(value_in_range({1.0, 3.0}, 0.0, 0), "1");
  EXPECT_EQ(value_in_range({1.0, 3.0}, 0.25, 0), "1.5");
  EXPECT_EQ(value_in_range({0.01, 1.0, true}, 0.5, 0), "0.1");
  EXPECT_EQ(value_in_range({0.0, 1.0}, 1.0 / 3.0, 0), "0.333333");
}

TEST(CampaignValues, IntegersAreMultiplesAndEquallyLikely) {
  std::map<std::string, int> counts;
  constexpr int kSamples = 3000;
  for (int i = 0; i < kSamples; ++i) ++counts[value_in_range({5.0, 26.0}, (i + 0.5) / kSamples, 8)];
  // 8, 16 and 24.
  ASSERT_EQ(counts.size(), 3U);
  for (const auto& [value, count] : counts) EXPECT_NEAR(count, kSamples / 3.0, 1.0) << value;
  EXPECT_TRUE(counts.contains("24"));
  EXPECT_EQ(value_in_range({1.0, 100.0, true}, 0.0, 1), "1");
  EXPECT_EQ(value_in_range({1.0, 100.0, true}, 0.999999, 1), "100");
}

TEST(CampaignValues, LatinHypercubeHasOneSampleInEachInterval) {
  constexpr size_t kCount = 40;
  const auto samples = latin_hypercube_sample(kCount, 3, 5);
  ASSERT_EQ(samples.size(), kCount);
  for (size_t d = 0; d < 3; ++d) {
    std::set<int> intervals;
    for (const auto& sample : samples)
      intervals.insert(static_cast<int>(std::floor(sample[d] * kCount)));
    EXPECT_EQ(intervals.size(), kCount);
    EXPECT_EQ(*intervals.begin(), 0);
    EXPECT_EQ(*intervals.rbegin(), static_cast<int>(kCount) - 1);
  }
  // Dimensions are shuffled apart.
  int same = 0;
  for (const auto& sample : samples)
    same += std::floor(sample[0] * kCount) == std::floor(sample[1] * kCount) ? 1 : 0;
  EXPECT_LT(same, 10);
}

TEST(CampaignValues, SamplesFollowTheirSeedAlone) {
  EXPECT_EQ(random_sample(5, 2, 1), random_sample(5, 2, 1));
  EXPECT_NE(random_sample(5, 2, 1), random_sample(5, 2, 2));
  EXPECT_EQ(latin_hypercube_sample(5, 2, 1), latin_hypercube_sample(5, 2, 1));
  EXPECT_NE(latin_hypercube_sample(5, 2, 1), latin_hypercube_sample(5, 2, 2));
  // A further range, and further samples, leave those before as they were.
  const auto few = random_sample(5, 2, 1);
  const auto more = random_sample(8, 3, 1);
  for (size_t i = 0; i < few.size(); ++i) {
    EXPECT_EQ(few[i][0], more[i][0]);
    EXPECT_EQ(few[i][1], more[i][1]);
  }
}

}  // namespace
}  // namespace screed
