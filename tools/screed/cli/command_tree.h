// A program's command line as data: its subcommands, arguments and options, in the order in which
// they were registered. Help, completion and manual are made from it. Header only, as
// option_words.h.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "tools/screed/cli/option_words.h"

namespace screed {

struct CommandNode {
  std::string name;  ///< "export"
  std::string path;  ///< "screed session export"
  std::string help;
  std::vector<OptionWords> arguments;  ///< by their place
  std::vector<OptionWords> options;
  std::vector<OptionWords> inherited;  ///< options of the groups above that are taken here as well
  std::vector<CommandNode> subcommands;

  /// The line of its use, without "Usage: ".
  std::string usage() const {
    std::string line = path;
    if (!options.empty()) line += " [OPTIONS]";
    for (const OptionWords& argument : arguments) {
      const std::string name_and_more = argument.names.front() + (argument.repeated ? "..." : "");
      line += argument.required ? " " + name_and_more : " [" + name_and_more + "]";
    }
    if (!subcommands.empty()) line += " SUBCOMMAND";
    return line;
  }
};

inline CommandNode command_tree(const CLI::App& app, const std::string& above = "",
                                const std::vector<OptionWords>& inherited = {}) {
  CommandNode node;
  node.name = app.get_name();
  node.path = above.empty() ? node.name : above + " " + node.name;
  node.help = app.get_description();
  node.inherited = inherited;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;  // hidden
    (option->get_positional() ? node.arguments : node.options).push_back(words_of(*option));
  }
  for (const CLI::App* below : app.get_subcommands({})) {
    std::vector<OptionWords> handed_down;
    // What the program itself takes (--version) stands before all subcommands.
    if (below->get_fallthrough() && !above.empty()) {
      handed_down = inherited;
      for (const OptionWords& option : node.options) {
        if (option.names.back() != "--help") handed_down.push_back(option);
      }
    }
    node.subcommands.push_back(command_tree(*below, node.path, handed_down));
  }
  return node;
}

}  // namespace screed
