// What a host program makes of its command line, and how it ends: 0 done, 1 the run failed, 2 the
// input was wrong, and then one line on standard error says what.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "tools/command_line/command.h"

namespace screed {

/// Parses the command line, then runs `body`, which returns the exit code. The program must carry
/// its name. `PROGRAM help sim` is `PROGRAM sim --help`.
int run_program(Command& program, int argc, char** argv, const std::function<int()>& body);

/// Reads the words behind the program's name: fills the targets of its options, then calls the
/// callback of the subcommand and of those above it. Returns what the user asked for by --help or
/// --version in place of that; empty: nothing. Throws UsageError.
std::string parse(Command& program, const std::vector<std::string>& words);

/// How many letters must be put in, left out, changed, or changed over with the next one, to make
/// `b` of `a` (Damerau 1964, no letter twice).
std::size_t edit_distance(const std::string& a, const std::string& b);

/// The nearest of `words`, the first of equals; empty where none differs by at most a third of its
/// letters.
std::string nearest_word(const std::string& mistyped, const std::vector<std::string>& words);

/// "; did you mean sim?", or nothing where no word is near.
std::string did_you_mean(const std::string& mistyped, const std::vector<std::string>& words);

}  // namespace screed
