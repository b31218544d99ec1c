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

/// A factor with two significant digits, "0.034", from 10 on as a whole number, "1234"; 0 is "0".
std::string factor_text(double value);

}  // namespace screed
