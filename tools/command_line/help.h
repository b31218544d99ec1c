// A command line in words that people read. Help, completion and manual are made from them.
#pragma once

#include <string>
#include <vector>

#include "tools/command_line/command.h"

namespace screed {

struct OptionWords {
  std::vector<std::string> names;  ///< "-h", "--help"; of an argument that has a place: "FILE"
  std::string value;               ///< "NUMBER", "FILE"; empty: takes none
  std::vector<std::string> choices;
  std::string range;  ///< "0.01 to 1000"
  std::string help;
  std::string group;     ///< the heading that it stands below: "Options"
  std::string fallback;  ///< the default; empty: none
  std::vector<std::string> needs;
  std::vector<std::string> excludes;
  bool is_positional = false;
  bool required = false;
  bool repeated = false;  ///< takes several values
};

OptionWords words_of(const Option& option);

/// The range, the choices, the default, and what goes together, as a sentence that follows the help
/// text: "(0 to 1; default: 0.5)". Empty: nothing to say.
std::string details(const OptionWords& words);

struct CommandNode {
  std::string name;  ///< "export"
  std::string path;  ///< "screed session export"
  std::string help;
  std::vector<OptionWords> arguments;  ///< by their place
  std::vector<OptionWords> options;
  std::vector<OptionWords> inherited;  ///< options of the groups above that are taken here as well
  std::vector<CommandNode> subcommands;

  /// The line of its use, without "Usage: ".
  std::string usage() const;
};

/// All in the order in which they were registered.
CommandNode command_tree(const Command& command);

/// The page of a program or of one of its subcommands under --help: one form, 80 columns wide.
std::string help_page(const Command& command);

}  // namespace screed
