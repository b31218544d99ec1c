// --help of every program: one form, 80 columns wide. Header only, as option_words.h.
#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include "tools/screed/cli/command_tree.h"

namespace screed {

namespace help_format {

inline constexpr std::size_t kWidth = 80;
inline constexpr std::size_t kColumn = 26;  ///< where descriptions begin

/// Words in lines of at most kWidth, all but the first indented; `at` is where the first begins.
inline std::string wrapped(const std::string& text, std::size_t indent, std::size_t at) {
  std::string lines;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const bool begins = at == indent;
    if (!begins && at + 1 + word.size() > kWidth) {
      lines += "\n" + std::string(indent, ' ') + word;
      at = indent + word.size();
    } else {
      lines += (begins ? "" : " ") + word;
      at += word.size() + (begins ? 0 : 1);
    }
  }
  return lines;
}

inline std::string row(const std::string& left, const std::string& right) {
  std::string text = "  " + left;
  if (right.empty()) return text + "\n";
  if (text.size() + 2 > kColumn) {
    text += "\n" + std::string(kColumn, ' ');
  } else {
    text.resize(kColumn, ' ');
  }
  return text + wrapped(right, kColumn, kColumn) + "\n";
}

inline std::string row(const OptionWords& words) {
  std::string left = CLI::detail::join(words.names, ", ");
  if (words.is_positional) {
    if (words.repeated) left += "...";
  } else if (!words.value.empty()) {
    left += " " + words.value;
  }
  return row(left, words.help + " " + details(words));
}

inline std::string rows(const std::string& heading, const std::vector<OptionWords>& options) {
  if (options.empty()) return "";
  std::string text = "\n" + heading + ":\n";
  for (const OptionWords& option : options) text += row(option);
  return text;
}

/// Below the headings of their groups, in the order in which these appear.
inline std::string grouped_rows(std::vector<OptionWords> options) {
  std::string text;
  while (!options.empty()) {
    const std::string group = options.front().group;
    const auto others =
        std::stable_partition(options.begin(), options.end(),
                              [&](const OptionWords& option) { return option.group == group; });
    text += rows(group, {options.begin(), others});
    options.erase(options.begin(), others);
  }
  return text;
}

inline std::string page(const CommandNode& node) {
  std::string text = wrapped(node.help, 0, 0) + "\n\n";
  text += "Usage: " + wrapped(node.usage(), 7, 7) + "\n";
  text += rows("Arguments", node.arguments);
  text += grouped_rows(node.options);
  text += rows("Options of " + node.path.substr(0, node.path.rfind(' ')), node.inherited);
  if (node.subcommands.empty()) return text;
  text += "\nSubcommands:\n";
  for (const CommandNode& below : node.subcommands) text += row(below.name, below.help);
  return text + "\n" + wrapped(node.path + " SUBCOMMAND --help describes each.", 0, 0) + "\n";
}

}  // namespace help_format

/// The page of the app itself; the names of the apps above it come from the parser.
class HelpFormat : public CLI::FormatterBase {
 public:
  std::string make_help(const CLI::App* app, std::string, CLI::AppFormatMode) const override {
    const CLI::App* root = app;
    std::vector<std::string> path;
    for (; root->get_parent() != nullptr; root = root->get_parent())
      path.push_back(root->get_name());
    CommandNode node = command_tree(*root);
    for (; !path.empty(); path.pop_back()) {
      const std::vector<CommandNode> subcommands = std::move(node.subcommands);
      node = *std::find_if(subcommands.begin(), subcommands.end(),
                           [&](const CommandNode& below) { return below.name == path.back(); });
    }
    return help_format::page(node);
  }
};

/// Gives a program and all its subcommands this form.
inline void use_help_format(CLI::App& app) {
  const auto format = std::make_shared<HelpFormat>();
  const std::function<void(CLI::App*)> give = [&](CLI::App* at) {
    at->formatter(format);
    for (CLI::App* below : at->get_subcommands({})) give(below);
  };
  give(&app);
}

}  // namespace screed
