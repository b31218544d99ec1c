// Completion for fish.
#include "tools/screed/manual/shell_completion.h"

namespace screed {
namespace {

std::string in_quotes(const std::string& text) {
  std::string safe = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') safe += '\\';
    safe += c;
  }
  return safe + "'";
}

/// Which subcommand the words so far have come to; true when it is that of the argument.
constexpr const char* kFishWalk = R"(
function __screed_at
    set -l path screed
    set -l value_due 0
    for word in (commandline -opc)[2..-1]
        if test $value_due = 1
            set value_due 0
        else if __screed_valued "$path $word"
            set value_due 1
        else if __screed_is_command "$path $word"
            set path "$path $word"
        end
    end
    test "$path" = "$argv[1]"
end

complete -c screed -f
)";

std::string function_of(const char* name, const std::vector<std::string>& words) {
  std::string text = std::string("function ") + name + "\n    contains -- \"$argv[1]\"";
  for (const std::string& word : words) text += " \\\n        " + in_quotes(word);
  return text + "\nend\n";
}

/// What may stand for a value, as flags of `complete`.
std::string value_flags(const OptionWords& words) {
  switch (value_kind(words)) {
    case ValueKind::kChoices: {
      std::string list;
      for (const std::string& choice : words.choices) list += (list.empty() ? "" : " ") + choice;
      return " -f -a " + in_quotes(list);
    }
    case ValueKind::kFolders:
      return " -f -a '(__fish_complete_directories)'";
    case ValueKind::kFiles:
      return " -F";
    case ValueKind::kNothing:
      break;
  }
  return " -f";
}

std::string lines_of(const CommandNode& node) {
  const std::string begin = "complete -c screed -n " + in_quotes("__screed_at '" + node.path + "'");
  std::string text;
  for (const CommandNode& below : node.subcommands)
    text += begin + " -a " + below.name + " -d " + in_quotes(below.help) + "\n";
  for (const OptionWords& option : all_options(node)) {
    text += begin;
    for (const std::string& name : option.names)
      text += name.rfind("--", 0) == 0 ? " -l " + name.substr(2) : " -s " + name.substr(1);
    if (!option.value.empty()) text += " -r" + value_flags(option);
    text += " -d " + in_quotes(option.help) + "\n";
  }
  for (const OptionWords& argument : node.arguments) {
    if (value_kind(argument) != ValueKind::kNothing) text += begin + value_flags(argument) + "\n";
  }
  return text;
}

}  // namespace

std::string fish_completion(const CommandNode& root) {
  std::vector<std::string> valued;
  std::vector<std::string> commands;
  std::string lines;
  for_each_node(root, [&](const CommandNode& node) {
    for (const CommandNode& below : node.subcommands) commands.push_back(below.path);
    for (const OptionWords& option : all_options(node)) {
      for (const std::string& name : option.names)
        if (!option.value.empty()) valued.push_back(node.path + " " + name);
    }
    lines += lines_of(node);
  });
  return "# Completion of screed for fish; made by `screed completion fish`.\n\n" +
         function_of("__screed_valued", valued) + "\n" +
         function_of("__screed_is_command", commands) + kFishWalk + lines;
}

}  // namespace screed
