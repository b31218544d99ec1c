// A curve with as many samples as a screen can show, and none of its peaks lost.
#pragma once

#include <cstdint>
#include <vector>

namespace screed {

/// Which ticks the samples of a curve stand for. A run of up to kMaxSamples ticks keeps them all.
/// A longer one is cut into buckets of equal numbers of ticks, the last one shorter; each gives two
/// samples, the lowest and the highest value in the order in which they occur.
struct CurveSampling {
  static constexpr std::uint64_t kMaxSamples = 3000;

  explicit CurveSampling(std::uint64_t ticks);
  /// Row of the session at which each sample is drawn. In a bucket: its first one and its middle,
  /// so a peak stands up to a bucket from where it was.
  std::vector<std::uint64_t> rows() const;

  std::uint64_t ticks;
  std::uint64_t bucket_ticks;  ///< 1: each tick is a sample
};

/// Takes the values of a curve tick by tick.
class CurveSampler {
 public:
  explicit CurveSampler(const CurveSampling& sampling) : sampling_(sampling) {}
  /// The value of the next tick; NaN where there is none.
  void add(double value);
  /// As many as CurveSampling::rows(), once all ticks were added; NaN for a bucket without values.
  std::vector<float> samples();

 private:
  void finish_bucket();

  CurveSampling sampling_;
  std::uint64_t in_bucket_ = 0;
  bool any_ = false;
  bool high_first_ = false;
  double low_ = 0.0;
  double high_ = 0.0;
  std::vector<float> samples_;
};

}  // namespace screed
