// Words that an option is likely to have, for help, completion and manual, where its subcommand
// checks the value itself.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "host_sim/core/name_list.h"

namespace screed {

/// For CLI::Option::check(); takes every text.
inline CLI::Validator suggested_words(const std::vector<std::string>& words) {
  return {[](std::string&) { return std::string(); }, "{" + name_list(words, ",") + "}"};
}

}  // namespace screed
