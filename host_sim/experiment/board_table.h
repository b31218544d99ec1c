// The boards this program knows by name: a folder boards/<name> each.
#pragma once

#include <string>

#include "firmware/robot/board_constants.h"

namespace screed {

inline constexpr const char* kDefaultBoard = "a_star_32u4";

/// Throws InputError for an unknown name; lists the known ones.
const BoardConstants& board_constants_of(const std::string& name);

}  // namespace screed
