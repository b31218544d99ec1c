// Completion for zsh: a function for each subcommand.
#include <algorithm>
#include <cstring>

#include "tools/screed/manual/shell_completion.h"

namespace screed {
namespace {

/// A text inside single quotes; `special` are the characters that the specification in which it
/// stands takes for its own.
std::string in_quotes(const std::string& text, const char* special) {
  std::string safe;
  for (const char c : text) {
    if (c == '\'') {
      safe += "'\\''";
      continue;
    }
    if (std::strchr(special, c) != nullptr) safe += '\\';
    safe += c;
  }
  return safe;
}

/// The description of an option: [...].
std::string in_brackets(const std::string& text) {
  return in_quotes(text, ":[]\\");
}

/// The description of a word in a list, inside double quotes: ((word\:"...")).
std::string in_word_list(const std::string& text) {
  return in_quotes(text, ":\"$`\\");
}

std::string function_name(const CommandNode& node) {
  std::string name = "_" + node.path;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

/// ":FILE:_files"
std::string action(const OptionWords& words) {
  const std::string before = ":" + in_brackets(words.value) + ":";
  switch (value_kind(words)) {
    case ValueKind::kChoices: {
      std::string list;
      for (const std::string& choice : words.choices) list += (list.empty() ? "" : " ") + choice;
      return before + "(" + list + ")";
    }
    case ValueKind::kFolders:
      return before + "_files -/";
    case ValueKind::kFiles:
      return before + "_files";
    case ValueKind::kNothing:
      break;
  }
  return before + " ";
}

std::string options_of(const CommandNode& node) {
  std::string text;
  for (const OptionWords& option : all_options(node)) {
    const bool takes_value = !option.value.empty();
    for (const std::string& name : option.names) {
      text += " \\\n    '";
      if (option.repeated) text += "*";
      text += name;
      if (takes_value) text += name.rfind("--", 0) == 0 ? "=" : "+";
      text += "[" + in_brackets(option.help) + "]";
      if (takes_value) text += action(option);
      text += "'";
    }
  }
  return text;
}

std::string arguments_of_node(const CommandNode& node) {
  std::string text;
  int place = 1;
  for (const OptionWords& argument : node.arguments) {
    OptionWords named = argument;
    named.value = argument.names.front();
    text +=
        " \\\n    '" + (argument.repeated ? std::string("*") : std::to_string(place)) +
        (value_kind(argument) == ValueKind::kNothing ? ":" + named.value + ": " : action(named)) +
        "'";
    ++place;
  }
  return text;
}

std::string function_of(const CommandNode& node) {
  std::string text = function_name(node) + "() {\n  local context state state_descr line\n" +
                     "  typeset -A opt_args\n  _arguments -S -C" + options_of(node) +
                     arguments_of_node(node);
  if (node.subcommands.empty()) return text + "\n}\n\n";
  text += " \\\n    '1:subcommand:((";
  for (const CommandNode& below : node.subcommands)
    text += below.name + "\\:\"" + in_word_list(below.help) + "\" ";
  text += "))' \\\n    '*:: :->below' && return 0\n  [[ $state == below ]] || return 1\n";
  text += "  case $line[1] in\n";
  for (const CommandNode& below : node.subcommands)
    text += "    " + below.name + ") " + function_name(below) + " ;;\n";
  return text + "  esac\n}\n\n";
}

}  // namespace

std::string zsh_completion(const CommandNode& root) {
  std::string text = "#compdef screed\n# Made by `screed completion zsh`.\n\n";
  for_each_node(root, [&](const CommandNode& node) { text += function_of(node); });
  // As a file of fpath it is the body of the function; sourced, it defines the completion.
  return text +
         "if [[ $funcstack[1] == _screed ]]; then\n  _screed \"$@\"\nelse\n"
         "  compdef _screed screed\nfi\n";
}

}  // namespace screed
