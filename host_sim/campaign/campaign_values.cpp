// Lists, ranges and samples.
#include "host_sim/campaign/campaign_values.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <set>

#include "host_sim/core/csv_file.h"
#include "host_sim/core/elementary.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "host_sim/run/experiment/experiment_keys.h"

namespace screed {
namespace {

constexpr size_t kMaxSeeds = 1'000'000;
constexpr const char* kRange = "..";
constexpr size_t kRangeLength = 2;

[[noreturn]] void refuse_seeds(const std::string& text, const std::string& where) {
  throw InputError(where + " = '" + text +
                   "' is not allowed; expected seeds as 1..30, or 1, 2, 10..20; at most " +
                   std::to_string(kMaxSeeds) + ", none twice");
}

[[noreturn]] void refuse_range(const std::string& text, const std::string& where) {
  throw InputError(where + " = '" + text +
                   "' is not allowed; expected a range as 0.1..0.5, or 0.001..0.1 log, the lower "
                   "end first, above 0 with log");
}

std::string trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(' ');
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

/// The two sides of "LOW..HIGH"; without dots both are the text.
std::array<std::string, 2> ends_of(const std::string& text) {
  const size_t dots = text.find(kRange);
  if (dots == std::string::npos) return {text, text};
  return {trimmed(text.substr(0, dots)), trimmed(text.substr(dots + kRangeLength))};
}

std::string six_digits(double value) {
  std::array<char, 32> text{};
  const auto result =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6);
  return {text.data(), result.ptr};
}

}  // namespace

std::vector<uint64_t> parse_seeds(const std::string& text, const std::string& where) {
  std::vector<uint64_t> seeds;
  std::set<uint64_t> seen;
  for (const std::string& part : split_csv_line(text, where)) {
    const auto [first_text, last_text] = ends_of(part);
    uint64_t first = 0;
    uint64_t last = 0;
    if (!parse_number(first_text, first) || !parse_number(last_text, last) || last < first ||
        last - first >= kMaxSeeds - seeds.size())
      refuse_seeds(text, where);
    for (uint64_t i = 0; i <= last - first; ++i) {
      if (!seen.insert(first + i).second) refuse_seeds(text, where);
      seeds.push_back(first + i);
    }
  }
  return seeds;
}

SampleRange parse_range(const std::string& text, const std::string& where) {
  SampleRange range;
  std::string numbers = text;
  constexpr std::string_view kLog = " log";
  if (text.ends_with(kLog)) {
    range.logarithmic = true;
    numbers = trimmed(text.substr(0, text.size() - kLog.size()));
  }
  const auto [low, high] = ends_of(numbers);
  if (numbers.find(kRange) == std::string::npos || !parse_number(low, range.low) ||
      !parse_number(high, range.high) || !std::isfinite(range.low) || !std::isfinite(range.high) ||
      range.low > range.high || (range.logarithmic && range.low <= 0.0))
    refuse_range(text, where);
  return range;
}

std::vector<std::vector<double>> random_sample(std::size_t count, std::size_t dimensions,
                                               uint64_t seed) {
  // A generator a dimension: a further range leaves the samples of the others as they were.
  std::vector<std::vector<double>> samples(count, std::vector<double>(dimensions));
  for (size_t d = 0; d < dimensions; ++d) {
    WorldRandom random(seed, "campaign random " + std::to_string(d));
    for (std::vector<double>& sample : samples) sample[d] = random.uniform();
  }
  return samples;
}

std::vector<std::vector<double>> latin_hypercube_sample(std::size_t count, std::size_t dimensions,
                                                        uint64_t seed) {
  std::vector<std::vector<double>> samples(count, std::vector<double>(dimensions));
  std::vector<size_t> interval(count);
  for (size_t d = 0; d < dimensions; ++d) {
    WorldRandom random(seed, "campaign latin hypercube " + std::to_string(d));
    std::iota(interval.begin(), interval.end(), size_t{0});
    // Fisher and Yates; std::shuffle differs between standard libraries.
    for (size_t i = count; i > 1; --i) {
      const auto other = static_cast<size_t>(random.uniform() * static_cast<double>(i));
      std::swap(interval[i - 1], interval[other]);
    }
    for (size_t i = 0; i < count; ++i) {
      samples[i][d] =
          (static_cast<double>(interval[i]) + random.uniform()) / static_cast<double>(count);
    }
  }
  return samples;
}

std::string value_in_range(const SampleRange& range, double share, uint64_t multiple_of) {
  const auto at = [&](double low, double high) {
    if (!range.logarithmic) return low + (high - low) * share;
    return low * portable::exp(share * portable::log(high / low));
  };
  if (multiple_of == 0) return six_digits(at(range.low, range.high));
  const auto step = static_cast<double>(multiple_of);
  const double first = std::ceil(range.low / step);
  const double last = std::floor(range.high / step);
  // Half a step beyond either end, so that the ends are as likely as the others.
  const double chosen = std::clamp(std::round(at(first - 0.5, last + 0.5)), first, last);
  return std::to_string(static_cast<int64_t>(chosen * step));
}

}  // namespace screed
