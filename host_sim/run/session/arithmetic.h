// How this program computes worlds.
#pragma once

#include <string>

namespace screed {

/// Two programs of one version with one arithmetic give the same bits, on whatever processor.
std::string arithmetic();

/// What a file means that names none: it is older than the names.
inline constexpr char kUnnamedArithmetic[] = "the C library's";

}  // namespace screed
