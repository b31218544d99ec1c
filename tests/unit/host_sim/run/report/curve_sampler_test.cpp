// Curves of the page: all ticks of a short run, the extremes of a long one.
#include "host_sim/run/report/page_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace screed {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

TEST(CurveSampler, KeepsEachTickOfAShortRun) {
  const CurveSampling sampling(CurveSampling::kMaxSamples);
  EXPECT_EQ(sampling.bucket_ticks, 1U);
  CurveSampler sampler(sampling);
  for (std::uint64_t i = 0; i < sampling.ticks; ++i) sampler.add(0.5 * static_cast<double>(i));
  const std::vector<float> samples = sampler.samples();
  ASSERT_EQ(samples.size(), sampling.rows().size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(sampling.rows()[i], i);
    EXPECT_EQ(samples[i], 0.5F * static_cast<float>(i));
  }
}

TEST(CurveSampler, KeepsThePeaksOfALongRunInTheirOrder) {
  const CurveSampling sampling(10 * CurveSampling::kMaxSamples + 1);
  const std::uint64_t bucket = sampling.bucket_ticks;
  ASSERT_GT(bucket, 10U);
  CurveSampler sampler(sampling);
  for (std::uint64_t i = 0; i < sampling.ticks; ++i) {
    // One spike up, later one down in the first bucket; the other way round in the second.
    const double spike = i == 3 || i == bucket + 7 ? 5.0 : i == 8 || i == bucket + 2 ? -5.0 : 1.0;
    sampler.add(spike);
  }
  const std::vector<float> samples = sampler.samples();
  ASSERT_EQ(samples.size(), sampling.rows().size());
  EXPECT_LE(samples.size(), CurveSampling::kMaxSamples);
  EXPECT_EQ(samples[0], 5.0F);
  EXPECT_EQ(samples[1], -5.0F);
  EXPECT_EQ(samples[2], -5.0F);
  EXPECT_EQ(samples[3], 5.0F);
  EXPECT_EQ(samples.back(), 1.0F);
  EXPECT_EQ(sampling.rows()[2], bucket);
  EXPECT_LT(sampling.rows().back(), sampling.ticks);
}

TEST(CurveSampler, PassesOverWhatIsNoNumber) {
  CurveSampler sampler(CurveSampling(2 * CurveSampling::kMaxSamples));  // buckets of four
  for (const double value : {kNan, 2.0, kNan, 1.0, kNan, kNan, kNan, kNan}) sampler.add(value);
  const std::vector<float> samples = sampler.samples();
  ASSERT_EQ(samples.size(), 4U);
  EXPECT_EQ(samples[0], 2.0F);
  EXPECT_EQ(samples[1], 1.0F);
  EXPECT_TRUE(std::isnan(samples[2]));
  EXPECT_TRUE(std::isnan(samples[3]));
}

}  // namespace
}  // namespace screed
