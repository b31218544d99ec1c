// Numbers as the user types them, and as texts and messages show them.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace screed {

/// The whole of `text` as a finite number, a sign in front allowed; nothing when it is anything
/// else: no number, too large for T, empty, with something behind it.
template <class T>
std::optional<T> finite_number(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  T value{};
  const char* const end = text.data() + text.size();
  const auto result = std::from_chars(text.data(), end, value);
  if (result.ec != std::errc() || result.ptr != end) return std::nullopt;
  if constexpr (std::is_floating_point_v<T>) {
    if (!std::isfinite(value)) return std::nullopt;
  }
  return value;
}

/// The whole of "40x30" as two whole numbers; nothing when it is anything else.
std::optional<std::pair<int, int>> whole_pair(std::string_view text);

/// The shortest text that reads as this number again, without an exponent where it is short.
std::string plain_text(double value);

}  // namespace screed
