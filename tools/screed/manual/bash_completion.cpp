// Completion for bash.
#include "tools/screed/manual/shell_completion.h"

namespace screed {
namespace {

/// The walk over the words so far: which subcommand, and whether an option's value is due. Bash
/// hands over --option=value as three words.
constexpr const char* kBashWalk = R"(
_screed() {
  local path=screed option= place=0 kind= i word
  local commands options valued
  local cur=${COMP_WORDS[COMP_CWORD]}
  COMPREPLY=()
  [[ $cur == '=' ]] && cur=
  _screed_at "$path"
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    if [[ -n $option ]]; then
      [[ $word == '=' ]] || option=
    elif [[ $valued == *" $word "* ]]; then
      option=$word
    elif [[ $word == -* || ($i == 1 && $word == help) ]]; then
      :
    elif [[ $commands == *" $word "* ]]; then
      path+=" $word"
      place=0
      _screed_at "$path"
    else
      place=$((place + 1))
    fi
  done
  if [[ -n $option ]]; then
    _screed_kind "$path $option"
  elif [[ $cur == -* ]]; then
    kind=" $options"
  elif [[ $commands != ' ' ]]; then
    kind=" $commands"
  else
    _screed_kind "$path @$place"
  fi
  case $kind in
    files) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- "$cur") ;;
    folders) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
    ' '*) mapfile -t COMPREPLY < <(compgen -W "$kind" -- "$cur") ;;
  esac
}
complete -F _screed screed
)";

std::string joined(const std::vector<std::string>& words) {
  std::string text = " ";
  for (const std::string& word : words) text += word + " ";
  return text;
}

std::string kind_text(const OptionWords& words) {
  switch (value_kind(words)) {
    case ValueKind::kChoices:
      return "'" + joined(words.choices) + "'";
    case ValueKind::kFolders:
      return "folders";
    case ValueKind::kFiles:
      return "files";
    case ValueKind::kNothing:
      break;
  }
  return "nothing";
}

/// A case of _screed_at: what may stand at a node.
std::string words_case(const CommandNode& node) {
  std::vector<std::string> commands;
  for (const CommandNode& below : node.subcommands) commands.push_back(below.name);
  std::vector<std::string> options;
  std::vector<std::string> valued;
  for (const OptionWords& option : all_options(node)) {
    for (const std::string& name : option.names) {
      options.push_back(name);
      if (!option.value.empty()) valued.push_back(name);
    }
  }
  return "    '" + node.path + "') commands='" + joined(commands) + "' options='" +
         joined(options) + "' valued='" + joined(valued) + "' ;;\n";
}

/// The cases of _screed_kind of a node: what the values of its options and its arguments may be.
std::string kind_cases(const CommandNode& node) {
  std::string text;
  for (const OptionWords& option : all_options(node)) {
    if (option.value.empty()) continue;
    for (const std::string& name : option.names)
      text += "    '" + node.path + " " + name + "') kind=" + kind_text(option) + " ;;\n";
  }
  int place = 0;
  for (const OptionWords& argument : node.arguments) {
    const std::string at = argument.repeated ? " @'*" : " @" + std::to_string(place) + "'";
    text += "    '" + node.path + at + ") kind=" + kind_text(argument) + " ;;\n";
    ++place;
  }
  return text;
}

}  // namespace

std::string bash_completion(const CommandNode& root) {
  std::string words;
  std::string kinds;
  for_each_node(root, [&](const CommandNode& node) {
    words += words_case(node);
    kinds += kind_cases(node);
  });
  return "# Completion of screed for bash; made by `screed completion bash`.\n\n"
         "_screed_at() {\n  case $1 in\n" +
         words + "  esac\n}\n\n_screed_kind() {\n  case $1 in\n" + kinds + "  esac\n}\n" +
         kBashWalk;
}

}  // namespace screed
