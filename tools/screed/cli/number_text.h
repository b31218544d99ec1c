// Numbers as the user types them, and as texts and messages show them.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "host_sim/core/finite_number.h"

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

}  // namespace screed
