// A command line in words that people read.
#include "tools/command_line/help.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <type_traits>
#include <utility>
#include <vector>

#include "host_sim/core/name_list.h"

namespace screed {
namespace {

/// The kind of value that a target holds.
struct ValueWord {
  template <class Value>
  const char* operator()(const Value*) const {
    if (std::is_floating_point_v<Value>) return "NUMBER";
    return std::is_arithmetic_v<Value> ? "INTEGER" : "TEXT";
  }
  const char* operator()(const std::optional<unsigned>*) const { return "INTEGER"; }
  const char* operator()(const std::vector<int>*) const { return "INTEGER"; }
  const char* operator()(const Option::Reader&) const { return "TEXT"; }
  const char* operator()(const Option::ShowHelp&) const { return ""; }
  const char* operator()(const Option::ShowVersion&) const { return ""; }
};

std::string range_text(const Option::Range& range) {
  std::ostringstream text;
  if (range.whole) {
    text << static_cast<int>(range.low) << " to " << static_cast<int>(range.high);
  } else {
    text << range.low << " to " << range.high;
  }
  return text.str();
}

/// An option whose value is a text of a kind that has no word is named like it: "--out OUT".
std::string word_of_name(const Option& option) {
  const std::string name = option.name();
  if (name.rfind("--", 0) != 0) return "TEXT";
  std::string word = name.substr(2);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return word;
}

/// Value and range: of "NUMBER:0 to 1" both.
void set_value(const Option& option, OptionWords& words) {
  const Option::Spec& spec = option.spec();
  const std::string type = spec.type.value_or(std::visit(ValueWord{}, spec.target));
  const std::size_t colon = type.find(':');
  words.value = type.substr(0, colon);
  if (words.value == "DIR") words.value = "FOLDER";
  if (words.value == "TEXT" && !words.is_positional) words.value = word_of_name(option);
  words.choices = spec.choices;
  if (colon != std::string::npos) words.range = type.substr(colon + 1);
  if (spec.range.has_value()) words.range = range_text(*spec.range);
  if (spec.positive) words.range = "more than 0";
}

/// Takes a default in words off the end of a help text: "Output folder (default: RUN/export)".
std::string take_default(std::string& help) {
  constexpr const char* kBegin = " (default: ";
  const std::size_t begin = help.rfind(kBegin);
  if (begin == std::string::npos || help.find(')', begin) + 1 != help.size()) return "";
  const std::size_t text = begin + std::string(kBegin).size();
  std::string fallback = help.substr(text, help.size() - 1 - text);
  help.resize(begin);
  return fallback;
}

/// Whether the help text says all of these words itself.
bool says_all(const std::string& help, const std::vector<std::string>& words) {
  return std::all_of(words.begin(), words.end(),
                     [&](const std::string& word) { return help.find(word) != std::string::npos; });
}

std::vector<std::string> names_of(const std::vector<const Option*>& options) {
  std::vector<std::string> names;
  names.reserve(options.size());
  for (const Option* option : options) names.push_back(option->name());
  std::sort(names.begin(), names.end());
  return names;
}

/// What the command takes of the groups above it. What the program itself takes (--version) stands
/// before all subcommands.
std::vector<OptionWords> inherited_by(const Command& command) {
  const Command* above = command.parent();
  if (!command.falls_through() || above == nullptr || above->parent() == nullptr) return {};
  std::vector<OptionWords> inherited = inherited_by(*above);
  for (const auto& option : above->options())
    if (!option->is_argument() && option->name() != "--help")
      inherited.push_back(words_of(*option));
  return inherited;
}

}  // namespace

OptionWords words_of(const Option& option) {
  const Option::Spec& spec = option.spec();
  OptionWords words;
  words.names = spec.names;
  words.help = spec.help;
  words.group = spec.group;
  words.required = spec.required;
  words.is_positional = option.is_argument();
  words.needs = names_of(spec.needs);
  words.excludes = names_of(spec.excludes);
  words.fallback = take_default(words.help);
  if (option.is_flag()) return words;
  set_value(option, words);
  if (words.fallback.empty() && !words.required) words.fallback = spec.fallback;
  words.repeated = option.is_repeated();
  return words;
}

std::string details(const OptionWords& words) {
  constexpr std::size_t kMaxChoices = 12;
  const bool lists_choices =
      words.choices.size() <= kMaxChoices && !says_all(words.help, words.choices);
  const bool says_repeated = words.help.find("may be repeated") != std::string::npos;
  std::vector<std::string> parts;
  if (!words.range.empty()) parts.push_back(words.range);
  if (lists_choices) parts.push_back(name_list(words.choices));
  if (words.required && !words.is_positional) parts.emplace_back("required");
  if (words.repeated && !words.is_positional && !says_repeated)
    parts.emplace_back("may be repeated");
  if (!words.needs.empty()) parts.push_back("needs " + name_list(words.needs));
  if (!words.excludes.empty()) parts.push_back("not with " + name_list(words.excludes));
  if (!words.fallback.empty()) parts.push_back("default: " + words.fallback);
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "(" : "; ") + part;
  return text.empty() ? "" : text + ")";
}

std::string CommandNode::usage() const {
  std::string line = path;
  if (!options.empty()) line += " [OPTIONS]";
  for (const OptionWords& argument : arguments) {
    const std::string name_and_more = argument.names.front() + (argument.repeated ? "..." : "");
    line += argument.required ? " " + name_and_more : " [" + name_and_more + "]";
  }
  if (!subcommands.empty()) line += " SUBCOMMAND";
  return line;
}

CommandNode command_tree(const Command& command) {
  CommandNode node;
  node.name = command.name();
  node.path = command.path();
  node.help = command.help();
  node.inherited = inherited_by(command);
  for (const auto& option : command.options())
    (option->is_argument() ? node.arguments : node.options).push_back(words_of(*option));
  for (const auto& below : command.subcommands()) node.subcommands.push_back(command_tree(*below));
  return node;
}

// ---- the page under --help ----

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
