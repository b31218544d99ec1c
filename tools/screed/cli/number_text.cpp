// Numbers as texts and messages show them.
#include "tools/screed/cli/number_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace screed {

std::optional<std::pair<int, int>> whole_pair(std::string_view text) {
  const std::size_t between = text.find('x');
  if (between == std::string_view::npos) return std::nullopt;
  const auto first = finite_number<int>(text.substr(0, between));
  const auto second = finite_number<int>(text.substr(between + 1));
  if (!first.has_value() || !second.has_value()) return std::nullopt;
  return std::pair(*first, *second);
}

std::string plain_text(double value) {
  constexpr double kPlainFrom = 1e-5;
  constexpr double kPlainTo = 1e10;
  const double size = std::abs(value);
  const bool plain = size == 0.0 || (size >= kPlainFrom && size < kPlainTo);
  std::array<char, 64> text{};
  const auto result =
      std::to_chars(text.data(), text.data() + text.size(), value,
                    plain ? std::chars_format::fixed : std::chars_format::scientific);
  return {text.data(), result.ptr};
}

std::string factor_text(double value) {
  constexpr int kMaxDecimals = 9;
  std::array<char, 330> text{};
  // 9.96 is 10 with two digits.
  std::snprintf(text.data(), text.size(), "%.1e", value);
  const double size = std::abs(std::strtod(text.data(), nullptr));
  const bool whole = size == 0.0 || size >= 10.0;
  const int decimals =
      whole ? 0 : std::min(kMaxDecimals, 1 - static_cast<int>(std::floor(std::log10(size))));
  std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
  return text.data();
}

std::string change_text(double before, double after) {
  if (before == 0.0) return after > 0.0 ? "worse" : "";
  std::array<char, 64> text{};
  const double percent = std::round((after / before - 1.0) * 1000.0) / 10.0;
  if (percent == 0.0) return "";
  std::snprintf(text.data(), text.size(), "%+.1f %% %s", percent,
                percent < 0.0 ? "better" : "worse");
  return text.data();
}

std::string share_change_text(double before, double after) {
  std::array<char, 64> text{};
  const double points = std::round((after - before) * 1000.0) / 10.0;
  if (points == 0.0) return "";
  std::snprintf(text.data(), text.size(), "%+.1f points %s", points,
                points > 0.0 ? "better" : "worse");
  return text.data();
}

}  // namespace screed
