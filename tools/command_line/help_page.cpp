// --help of every program.
#include "tools/command_line/help_page.h"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include "host_sim/core/name_list.h"
#include "tools/command_line/command_tree.h"

namespace screed {
namespace {

constexpr std::size_t kWidth = 80;
constexpr std::size_t kColumn = 26;  ///< where descriptions begin

/// Words in lines of at most kWidth, all but the first indented; `at` is where the first begins.
std::string wrapped(const std::string& text, std::size_t indent, std::size_t at) {
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

std::string row(const std::string& left, const std::string& right) {
  std::string text = "  " + left;
  if (right.empty()) return text + "\n";
  if (text.size() + 2 > kColumn) {
    text += "\n" + std::string(kColumn, ' ');
  } else {
    text.resize(kColumn, ' ');
  }
  return text + wrapped(right, kColumn, kColumn) + "\n";
}

std::string row(const OptionWords& words) {
  std::string left = name_list(words.names);
  if (words.is_positional) {
    if (words.repeated) left += "...";
  } else if (!words.value.empty()) {
    left += " " + words.value;
  }
  return row(left, words.help + " " + details(words));
}

std::string rows(const std::string& heading, const std::vector<OptionWords>& options) {
  if (options.empty()) return "";
  std::string text = "\n" + heading + ":\n";
  for (const OptionWords& option : options) text += row(option);
  return text;
}

/// Below the headings of their groups, in the order in which these appear.
std::string grouped_rows(std::vector<OptionWords> options) {
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

}  // namespace

std::string help_page(const Command& command) {
  const CommandNode node = command_tree(command);
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

}  // namespace screed
