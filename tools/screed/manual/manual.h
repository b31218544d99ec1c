// What the program says of its own command line: what may stand next, for shells, and man pages.
#pragma once

#include <string>
#include <vector>

#include "tools/command_line/help.h"

namespace screed {

/// A word that may stand at a place of the command line.
struct Offer {
  std::string word;
  std::string meaning;  ///< empty: none

  bool operator==(const Offer&) const = default;
};

/// What may stand for the last of these words, "" for a new one; the words before it are behind the
/// program's name. A single "/files" or "/folders": the shell knows better.
std::vector<Offer> offers_after(const CommandNode& root, const std::vector<std::string>& words);

/// The page of the program itself (man(7)), with a list of its subcommands.
std::string roff_page(const CommandNode& root, const std::string& version);

/// The page of a subcommand of the program, with those below it.
std::string roff_page(const CommandNode& root, const CommandNode& subcommand,
                      const std::string& version);

}  // namespace screed
