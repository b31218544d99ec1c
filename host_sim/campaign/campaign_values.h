// The values that a campaign file gives to keys: lists, ranges, samples of ranges.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace screed {

/// Seeds as "1..30", "4", or several of these separated by commas; none twice. Throws InputError
/// that begins with `where`.
std::vector<uint64_t> parse_seeds(const std::string& text, const std::string& where);

/// A range that samples are drawn from, both ends included.
struct SampleRange {
  double low = 0.0;
  double high = 0.0;
  bool logarithmic = false;  ///< the logarithm is uniform; low > 0
};

/// A range as "LOW..HIGH" or "LOW..HIGH log". Throws InputError that begins with `where`.
SampleRange parse_range(const std::string& text, const std::string& where);

/// Uniform numbers in [0, 1) by sample and dimension, independent of one another.
std::vector<std::vector<double>> random_sample(std::size_t count, std::size_t dimensions,
                                               uint64_t seed);
/// The same as a Latin hypercube (McKay et al. 1979): in each dimension one sample lies in each of
/// `count` intervals of equal width.
std::vector<std::vector<double>> latin_hypercube_sample(std::size_t count, std::size_t dimensions,
                                                        uint64_t seed);

/// The value of a range at the share 0..1 of it, as text with six significant digits: the same text
/// on machines whose logarithm differs in the last bit. With `multiple_of` > 0 an integer, a
/// multiple of it within the range, each of them equally likely unless the range is logarithmic.
std::string value_in_range(const SampleRange& range, double share, uint64_t multiple_of);

}  // namespace screed
