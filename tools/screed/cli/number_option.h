// Numbers as the user types them and as messages show them, and options that are numbers. Every
// number of every subcommand is added here, with its range, so that nothing else need expect nan,
// inf, an empty text or a count beyond all memory.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "host_sim/core/finite_number.h"
#include "tools/command_line/command.h"

namespace screed {

/// The whole of "40x30" as two whole numbers; nothing when it is anything else.
std::optional<std::pair<int, int>> whole_pair(std::string_view text);

/// The shortest text that reads as this number again, without an exponent where it is short.
std::string plain_text(double value);

/// What became of a figure that is better the smaller it is: "-35.3 % better", "+4.1 % worse", or
/// nothing where it did not change by the last digit. What was 0 and is not has no per cent.
std::string change_text(double before, double after);

/// The same of a share, 0..1, that is better the greater it is: "+12.0 points better".
std::string share_change_text(double before, double after);

/// A factor with two significant digits, "0.034", from 10 on as a whole number, "1234"; 0 is "0".
std::string factor_text(double value);

/// What a number may be; both ends are allowed.
struct NumberRange {
  double low;
  double high;
  bool or_zero = false;  ///< 0 is allowed beside low..high, where it stands for "none", "no limit"
  int multiple_of = 1;   ///< of whole numbers

  bool contains(double value) const;
};

/// Every seed: all of uint64_t, whose own limit is no double.
inline constexpr NumberRange kSeedRange{0.0, 0x1p64};
/// Counts of drives, epochs and the like, which take time but no memory.
inline constexpr NumberRange kCountRange{1, 1e9};
/// A share or a probability.
inline constexpr NumberRange kShareRange{0, 1};

/// What add_number() is made of: what does not depend on the number's type.
namespace number_option {

/// The value's type inside std::optional and std::vector.
template <class Value>
struct Element {
  using Type = Value;
  static constexpr bool kSeveral = false;
};
template <class Value>
struct Element<std::optional<Value>> : Element<Value> {};
template <class Value>
struct Element<std::vector<Value>> : Element<Value> {
  static constexpr bool kSeveral = true;
};

struct Description {
  std::string name;
  std::string help;
  NumberRange range;
  bool whole;    ///< of integers
  bool several;  ///< as 1,2,3 and by saying the option again
};

/// Takes the text of one number; false when it is none, or out of range.
using Take = std::function<bool(const std::string& text)>;

/// `begin` is called before the first number of a command line; `shown` is the default, for the
/// help; "" for none.
Option* add(Command& command, const Description& description, const std::function<void()>& begin,
            const Take& take, const std::string& shown);

template <class T>
std::string shown_number(const T& value) {
  if constexpr (std::is_floating_point_v<T>) {
    return plain_text(static_cast<double>(value));
  } else {
    return std::to_string(value);
  }
}

}  // namespace number_option

/// Adds an option, or a positional argument, that is one number: a floating-point or integer type,
/// or std::optional of one; or several: std::vector. What is not finite, not whole where whole
/// numbers are wanted, or out of range ends the parsing with one line that names the option and
/// says what is allowed; the help says the range as well.
template <class Value>
Option* add_number(Command& command, const std::string& name, Value& value, const std::string& help,
                   const NumberRange& range) {
  using Kind = number_option::Element<Value>;
  using T = typename Kind::Type;
  static_assert(std::is_arithmetic_v<T> && !std::is_same_v<T, bool>);
  std::function<void()> begin = [] {};
  if constexpr (Kind::kSeveral) begin = [&value] { value.clear(); };
  const auto take = [&value, range](const std::string& text) {
    const std::optional<T> number = finite_number<T>(text);
    if (!number.has_value() || !range.contains(static_cast<double>(*number))) return false;
    if constexpr (Kind::kSeveral) {
      value.push_back(*number);
    } else {
      value = *number;
    }
    return true;
  };
  std::string shown;
  if constexpr (Kind::kSeveral) {
    for (const T& one : value)
      shown += (shown.empty() ? "" : ",") + number_option::shown_number(one);
  } else if constexpr (std::is_same_v<Value, std::optional<T>>) {
    if (value.has_value()) shown = number_option::shown_number(*value);
  } else {
    shown = number_option::shown_number(value);
  }
  return number_option::add(command, {name, help, range, std::is_integral_v<T>, Kind::kSeveral},
                            begin, take, shown);
}

}  // namespace screed
