// Numbers as texts and messages show them; options that are numbers: ranges as text, and what is
// said about a number that is refused.
#include "tools/screed/cli/number_option.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "host_sim/core/figures.h"

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
  // 9.96 is 10 with two digits.
  const double size = std::abs(std::strtod(filled("{:.1e}", value).c_str(), nullptr));
  const bool whole = size == 0.0 || size >= 10.0;
  const int decimals =
      whole ? 0 : std::min(kMaxDecimals, 1 - static_cast<int>(std::floor(std::log10(size))));
  return filled("{:." + std::to_string(decimals) + "f}", value);
}

std::string change_text(double before, double after) {
  if (before == 0.0) return after > 0.0 ? "worse" : "";
  const double percent = std::round((after / before - 1.0) * 1000.0) / 10.0;
  if (percent == 0.0) return "";
  return filled("{:+.1f} % {}", percent, percent < 0.0 ? "better" : "worse");
}

std::string share_change_text(double before, double after) {
  const double points = std::round((after - before) * 1000.0) / 10.0;
  if (points == 0.0) return "";
  return filled("{:+.1f} points {}", points, points > 0.0 ? "better" : "worse");
}

namespace {

/// One end of a range. Whole numbers are written out.
std::string end_text(double value, bool whole) {
  if (!whole) return plain_text(value);
  if (value >= kSeedRange.high) return std::to_string(UINT64_MAX);
  return std::to_string(static_cast<std::int64_t>(value));
}

std::string range_text(const number_option::Description& number, const char* between) {
  return end_text(number.range.low, number.whole) + between +
         end_text(number.range.high, number.whole);
}

/// For the help: "0.01 to 1000".
std::string short_text(const number_option::Description& number) {
  const std::string zero = number.range.or_zero ? "0 or " : "";
  if (number.range.high >= kSeedRange.high)
    return zero + end_text(number.range.low, number.whole) + " or more";
  return zero + range_text(number, " to ");
}

/// For a message: "allowed are 0.01 to 1000".
std::string allowed_text(const number_option::Description& number) {
  std::string text = number.whole ? "allowed are whole numbers " : "allowed are ";
  text += range_text(number, " to ");
  if (number.range.multiple_of != 1) {
    text += ", each a multiple of " + std::to_string(number.range.multiple_of);
  }
  return text + (number.range.or_zero ? ", and 0" : "");
}

/// As it was typed, but on one line, of bounded length, and seen where it is empty.
std::string quoted(const std::string& text) {
  constexpr std::size_t kMax = 40;
  std::string shown = text.substr(0, kMax);
  bool plain = !shown.empty();
  for (char& c : shown) {
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
    plain = plain && c != ' ';
  }
  if (text.size() > kMax) shown += "...";
  return plain ? shown : "'" + shown + "'";
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (;;) {
    const std::size_t comma = text.find(',', begin);
    parts.push_back(text.substr(begin, comma - begin));
    if (comma == std::string::npos) return parts;
    begin = comma + 1;
  }
}

}  // namespace

bool NumberRange::contains(double value) const {
  if (or_zero && value == 0) return true;
  if (!(value >= low && value <= high)) return false;
  return multiple_of == 1 || std::fmod(value, static_cast<double>(multiple_of)) == 0;
}

namespace number_option {

Option* add(Command& command, const Description& description, const std::function<void()>& begin,
            const Take& take, const std::string& shown) {
  const Option::Reader read = [=](const Option& option, const std::vector<std::string>& texts) {
    begin();
    for (const std::string& text : texts) {
      for (const std::string& one : description.several ? split(text) : std::vector{text}) {
        if (!take(one))
          throw UsageError(option.name() + " " + quoted(one) + ": " + allowed_text(description));
      }
    }
  };
  Option* const added = command.add_option(description.name, read, description.help);
  added->type_name((description.whole ? "INTEGER:" : "NUMBER:") + short_text(description));
  added->show_default(shown);
  if (description.several) added->expected(1, -1)->one_value_each();
  return added;
}

}  // namespace number_option

}  // namespace screed
