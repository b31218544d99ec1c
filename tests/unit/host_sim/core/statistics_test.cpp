// Statistics against published tables and other programs.
#include <gtest/gtest.h>
#include <algorithm>
#include <cmath>

#include "host_sim/core/statistics.h"

namespace screed {

namespace {

// Quantiles of small samples, by hand.

TEST(Quantile, IsTheOrderStatisticWhereTheShareMeetsOne) {
  const std::vector<double> values = {30.0, 10.0, 50.0, 20.0, 40.0};
  EXPECT_EQ(quantile(values, 0.0), 10.0);
  EXPECT_EQ(quantile(values, 0.25), 20.0);
  EXPECT_EQ(quantile(values, 0.5), 30.0);
  EXPECT_EQ(quantile(values, 0.75), 40.0);
  EXPECT_EQ(quantile(values, 1.0), 50.0);
}

TEST(Quantile, InterpolatesLinearlyInBetween) {
  EXPECT_DOUBLE_EQ(quantile({0.0, 10.0}, 0.8), 8.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 4.0, 8.0}, 0.5), 3.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 4.0, 8.0}, 0.9), 6.8);
}

TEST(Quantile, OfOneValueIsThatValueAndOfNoneNothing) {
  for (const double share : {0.0, 0.3, 1.0}) EXPECT_EQ(quantile({7.0}, share), 7.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

// Confidence intervals against published tables and another program.

TEST(Intervals, WilsonsIsThatOfTheTables) {
  // Newcombe, Statistics in Medicine 17 (1998), table I, method 3.
  EXPECT_NEAR(wilson(81, 263).low, 0.2553, 5e-5);
  EXPECT_NEAR(wilson(81, 263).high, 0.3662, 5e-5);
  EXPECT_NEAR(wilson(15, 148).low, 0.0624, 5e-5);
  EXPECT_NEAR(wilson(15, 148).high, 0.1605, 5e-5);
  EXPECT_NEAR(wilson(0, 20).low, 0.0, 1e-12);
  EXPECT_NEAR(wilson(0, 20).high, 0.1611, 5e-5);
  EXPECT_EQ(wilson(0, 0).low, 0.0);
  EXPECT_EQ(wilson(0, 0).high, 1.0);
}

TEST(Intervals, PoissonsIsGarwoods) {
  // Exact limits: 0 (0 to 3.689), 3 (0.619 to 8.767), 10 (4.795 to 18.39).
  EXPECT_EQ(poisson(0).low, 0.0);
  EXPECT_NEAR(poisson(0).high, 3.689, 0.025);
  EXPECT_NEAR(poisson(3).low, 0.619, 0.025);
  EXPECT_NEAR(poisson(3).high, 8.767, 0.025);
  EXPECT_NEAR(poisson(10).low, 4.795, 0.025);
  EXPECT_NEAR(poisson(10).high, 18.39, 0.025);
}

// E. B. Wilson, J. Am. Stat. Assoc. 22, 1927; values by R's binom::binom.wilson.
TEST(Intervals, WilsonsAgreesWithAnotherProgram) {
  const Interval half = wilson(5, 10);
  EXPECT_NEAR(half.low, 0.2366, 1e-4);
  EXPECT_NEAR(half.high, 0.7634, 1e-4);
  const Interval none = wilson(0, 10);
  EXPECT_NEAR(none.low, 0.0, 1e-12);
  EXPECT_NEAR(none.high, 0.2775, 1e-4);
  const Interval all = wilson(10, 10);
  EXPECT_NEAR(all.low, 0.7225, 1e-4);
  EXPECT_NEAR(all.high, 1.0, 1e-12);
}

// Statistics of paired runs against SciPy 1.10, enumeration and published examples.

const std::vector<double> kEven = {1.2, 0.4, -0.3, 2.2, 1.9, 0.05, 0.7, -1.1, 3.4, 0.9, 0.2, 1.4};
const std::vector<double> kSkewed = {0.1, 0.2, 0.15, 0.3, 0.12, 5.0, 0.22, 0.4, 9.0, 0.18};

TEST(PairedStatistics, TheIntervalOfTheMeanIsSciPys) {
  // scipy.stats.bootstrap((values,), numpy.mean, method='BCa', n_resamples=200000)
  const Interval even = bootstrap_mean_interval(kEven);
  EXPECT_NEAR(even.low, 0.306, 0.04);
  EXPECT_NEAR(even.high, 1.625, 0.04);
  // Not symmetrical round 1.567: by percentiles it would be 0.2 to 3.3.
  const Interval skewed = bootstrap_mean_interval(kSkewed);
  EXPECT_NEAR(skewed.low, 0.215, 0.02);
  EXPECT_NEAR(skewed.high, 4.28, 0.25);
}

TEST(PairedStatistics, TheIntervalIsCorrectedForTheBiasOfItsSamples) {
  // BCa by the exact distribution of all 8^8 samples: z0 is 0.1535. Without it the ends would
  // be 19.9 and 388.1, with one of the two places that it stands in, 24.1 and 408.4 or 25.6 and
  // 400.5.
  const Interval powers = bootstrap_mean_interval({0, 1, 3, 9, 27, 81, 243, 729});
  EXPECT_NEAR(powers.low, 32.0, 3.0);
  EXPECT_NEAR(powers.high, 428.6, 8.0);
}

// Of samples that are as the values are, half count as below. Exactly, of 10^10 samples: 0.2 to
// 0.8; if all of them counted, 0.3 to 0.9, if none did, 0.1 to 0.7.
TEST(PairedStatistics, EqualSamplesAreHalfBelow) {
  const Interval interval = bootstrap_mean_interval({0, 0, 0, 0, 0, 1, 1, 1, 1, 1});
  EXPECT_DOUBLE_EQ(interval.low, 0.2);
  EXPECT_DOUBLE_EQ(interval.high, 0.8);
}

TEST(PairedStatistics, TheIntervalHoldsTheMeanInNineteenOfTwenty) {
  // 20 values of a known distribution, 500 times; BCa of 20 covers some 93 per cent.
  int held = 0;
  unsigned state = 1;
  const auto uniform = [&state] {
    state = state * 1664525U + 1013904223U;
    return (state >> 8U) * 0x1p-24;
  };
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<double> values(20);
    for (double& value : values) value = uniform() + uniform() + uniform();
    const Interval interval = bootstrap_mean_interval(values);
    held += interval.low <= 1.5 && 1.5 <= interval.high ? 1 : 0;
  }
  EXPECT_GE(held, 450);
  EXPECT_LE(held, 490);
}

TEST(PairedStatistics, TheIntervalOfARatioIsSciPys) {
  // scipy.stats.bootstrap((over, under), lambda x, y, axis: x.mean(axis) / y.mean(axis),
  // method='BCa', paired=True, n_resamples=100000)
  const std::vector<double> under = {2.1, 1.7, 1.1, 2.9, 2.4, 1.2, 1.6, 0.8, 3.9, 1.9, 1.3, 2.2};
  const Interval interval = bootstrap_ratio_interval(kEven, under);
  EXPECT_NEAR(interval.low, 0.195, 0.015);
  EXPECT_NEAR(interval.high, 0.665, 0.015);
  // Pairs: put otherwise together they say less.
  std::vector<double> turned(under.rbegin(), under.rend());
  const Interval apart = bootstrap_ratio_interval(kEven, turned);
  EXPECT_GT(apart.high - apart.low, 1.2 * (interval.high - interval.low));
}

TEST(PairedStatistics, ByAMeanThatMayBeNothingThereIsNoRatio) {
  const std::vector<double> around = {0.1, -0.1, 0.2, -0.2, 0.05, -0.1, 0.1, 0.0, 0.1, -0.1, 0, 0};
  EXPECT_TRUE(std::isnan(bootstrap_ratio_interval(kEven, around).low));
  const std::vector<double> negative = {-1.0, -2.0, -4.0};
  EXPECT_EQ(bootstrap_ratio_interval({2.0, 4.0, 8.0}, negative).low, -2.0);
}

TEST(PairedStatistics, OfTooFewOrEqualValuesTheIntervalSaysSo) {
  EXPECT_TRUE(std::isnan(bootstrap_mean_interval({3.0}).low));
  EXPECT_TRUE(std::isnan(mean_of({})));
  EXPECT_EQ(bootstrap_mean_interval({2.5, 2.5, 2.5}).low, 2.5);
  EXPECT_EQ(bootstrap_mean_interval({2.5, 2.5, 2.5}).high, 2.5);
}

TEST(PairedStatistics, MeansAndTheirIntervalsLieBetweenTheValuesToTheBit) {
  // The sum of five times the greatest, by five, is one bit more than it.
  const double greatest = 15.003904621516016;
  const Interval interval =
      bootstrap_mean_interval({greatest, greatest, 13.18738245173786, greatest, greatest});
  EXPECT_EQ(interval.high, greatest);
  EXPECT_GE(interval.low, 13.18738245173786);
  EXPECT_EQ(mean_of({greatest, greatest, greatest, greatest, greatest}), greatest);
}

TEST(PairedStatistics, WilcoxonsTestIsSciPys) {
  // scipy.stats.wilcoxon(values, mode='exact'): 10 of 78 fall.
  const SignedRank result = signed_rank(kEven);
  EXPECT_NEAR(result.p, 0.02099609375, 1e-12);
  EXPECT_NEAR(result.effect, (68.0 - 10.0) / 78.0, 1e-12);
  EXPECT_EQ(result.pairs, 12U);
}

TEST(PairedStatistics, WilcoxonsTestIsExactWithTies) {
  // By enumeration of all 512 signs; the 0 is left out.
  const SignedRank result = signed_rank({1, 1, 2, -2, 3, 3, -1, 4, 0, 2});
  EXPECT_NEAR(result.p, 0.078125, 1e-12);
  EXPECT_EQ(result.pairs, 9U);
}

TEST(PairedStatistics, OfManyPairsTheNormalDistributionAgreesWithTheExactOne) {
  std::vector<double> few;
  std::vector<double> many;
  for (int i = 0; i < 201; ++i) {
    const double value = std::sin(i * 12.9898) + 0.12;
    if (i < 200) few.push_back(value);
    many.push_back(value);
  }
  EXPECT_NEAR(signed_rank(few).p, signed_rank(many).p, 0.02);
  EXPECT_GT(signed_rank(few).p, 0.001);
  EXPECT_LT(signed_rank(few).p, 0.3);
}

TEST(PairedStatistics, NoDifferenceIsNoEvidence) {
  EXPECT_EQ(signed_rank({}).p, 1.0);
  EXPECT_EQ(signed_rank({0.0, 0.0}).p, 1.0);
  EXPECT_EQ(signed_rank({1.0, -1.0}).effect, 0.0);
  EXPECT_EQ(signed_rank({1.0, -1.0}).p, 1.0);
}

TEST(PairedStatistics, HolmsAdjustmentIsThatOfTheTextbook) {
  // R: p.adjust(c(0.01, 0.04, 0.03, 0.005), "holm") is 0.03 0.06 0.06 0.02.
  const std::vector<double> adjusted = holm({0.01, 0.04, 0.03, 0.005});
  EXPECT_NEAR(adjusted[0], 0.03, 1e-12);
  EXPECT_NEAR(adjusted[1], 0.06, 1e-12);
  EXPECT_NEAR(adjusted[2], 0.06, 1e-12);
  EXPECT_NEAR(adjusted[3], 0.02, 1e-12);
  EXPECT_EQ(holm({0.7, 0.8}).front(), 1.0);
}

// scipy.stats.kendalltau
TEST(PairedStatistics, KendallsTauIsSciPys) {
  EXPECT_NEAR(kendall_tau({1, 2, 3, 4, 5}, {2, 1, 4, 3, 5}), 0.6, 1e-12);
  EXPECT_NEAR(kendall_tau({1, 2, 2, 4}, {3, 1, 2, 4}), 0.18257418583505539, 1e-12);
  EXPECT_NEAR(kendall_tau({1, 2, 3}, {9, 5, 1}), -1.0, 1e-12);
  EXPECT_TRUE(std::isnan(kendall_tau({1, 1, 1}, {1, 2, 3})));
}

TEST(PairedStatistics, PercentilesOfAFigureOfPairs) {
  const std::vector<double> values = {1.0, 2.0, 3.0, 4.0, 5.0};
  const auto largest = [&](const std::vector<std::size_t>& chosen) {
    double most = 0.0;
    for (const std::size_t one : chosen) most = std::max(most, values[one]);
    return most;
  };
  const Interval interval = bootstrap_percentiles(values.size(), largest);
  EXPECT_EQ(interval.high, 5.0);
  EXPECT_EQ(interval.low,
            3.0);  // the largest of five is 3 or less in 0.6^5 = 8 %, 2 or less in 1 %
}

TEST(PairedStatistics, RanksAreMeansOverTheRows) {
  const std::vector<MeanRank> ranks =
      mean_ranks({{0.1, 0.3, 0.2}, {5.0, 7.0, 7.0}, {-1.0, 2.0, 1.0}});
  ASSERT_EQ(ranks.size(), 3U);
  EXPECT_NEAR(ranks[0].mean, 1.0, 1e-12);
  EXPECT_NEAR(ranks[1].mean, 8.5 / 3.0, 1e-12);
  EXPECT_NEAR(ranks[2].mean, 6.5 / 3.0, 1e-12);
  EXPECT_EQ(ranks[0].interval.low, 1.0);
  EXPECT_LT(ranks[1].interval.low, ranks[1].mean);
  EXPECT_TRUE(mean_ranks({}).empty());
}

}  // namespace

}  // namespace screed
