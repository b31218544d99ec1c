// `screed completion SHELL`: a script that completes this command line in a shell.
//
// The scripts know no command: they ask the program what may stand next, with the words so far,
// `screed completion SHELL -- WORD...`, and do with files and folders as their shell does.
#include <algorithm>
#include <iostream>
#include <string>
#include <vector>

#include "tools/screed/cli/command.h"
#include "tools/screed/manual/manual.h"

namespace screed {
namespace {

struct CompletionArguments {
  std::string shell;
  std::vector<std::string> words;
};

/// As lines of the answer in place of words, none of which begins like this.
constexpr const char* kAnyFile = "/files";
constexpr const char* kAnyFolder = "/folders";

/// Bash hands over --option=value as three words.
constexpr const char* kBash = R"(# Completion of screed for bash; made by `screed completion bash`.

_screed() {
  local cur=${COMP_WORDS[COMP_CWORD]} offers
  mapfile -t offers < <("${COMP_WORDS[0]/#\~/$HOME}" completion bash -- \
    "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null)
  [[ $cur == '=' ]] && cur=
  case ${offers[0]} in
    /files) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -f -- "$cur") ;;
    /folders) compopt -o filenames; mapfile -t COMPREPLY < <(compgen -d -- "$cur") ;;
    *) mapfile -t COMPREPLY < <(compgen -W "${offers[*]}" -- "$cur") ;;
  esac
}
complete -F _screed screed
)";

/// As a file of fpath it is the body of the function; sourced, it defines the completion.
constexpr const char* kZsh = R"(#compdef screed
# Made by `screed completion zsh`.

_screed() {
  local -a offers
  offers=("${(@f)$(${~${(Q)words[1]}} completion zsh -- "${(@Q)words[2,CURRENT]}" 2> /dev/null)}")
  compset -P 1 '--*='
  case $offers[1] in
    /files) _files ;;
    /folders) _files -/ ;;
    ?*) _describe word offers ;;
  esac
}

if [[ $funcstack[1] == _screed ]]; then
  _screed "$@"
else
  compdef _screed screed
fi
)";

constexpr const char* kFish = R"(# Completion of screed for fish; made by `screed completion fish`.

function __screed_offers
    set -l words (commandline -opc)
    set -l last (commandline -ct)
    set -l offers ($words[1] completion fish -- $words[2..-1] "$last" 2> /dev/null)
    set -l option (string match -r -- '^--[^=]*=' "$last")
    set -l value (string replace -- "$option" '' "$last")
    switch "$offers[1]"
        case /files
            set offers (__fish_complete_path "$value")
        case /folders
            set offers (__fish_complete_directories "$value")
    end
    test -z "$offers"; or printf '%s\n' "$option"$offers
end

complete -c screed -f -a '(__screed_offers)'
)";

/// The options that are taken at this node.
std::vector<OptionWords> all_options(const CommandNode& node) {
  std::vector<OptionWords> all = node.options;
  all.insert(all.end(), node.inherited.begin(), node.inherited.end());
  return all;
}

std::vector<Offer> offers_for(const OptionWords& value) {
  std::vector<Offer> offers;
  for (const std::string& choice : value.choices) offers.push_back({choice, ""});
  if (!offers.empty() || value.value == "NUMBER" || value.value == "INTEGER") return offers;
  return {{value.value == "FOLDER" ? kAnyFolder : kAnyFile, ""}};
}

/// A line of the answer: zsh wants word:meaning, fish both with a tab between.
std::string line_for(const std::string& shell, const Offer& offer) {
  if (shell == "bash" || offer.meaning.empty()) return offer.word;
  return offer.word + (shell == "zsh" ? ":" : "\t") + offer.meaning;
}

int run_completion(const CompletionArguments& arguments, const Command& root) {
  const std::string& shell = arguments.shell;
  if (arguments.words.empty()) {
    std::cout << (shell == "bash" ? kBash : shell == "zsh" ? kZsh : kFish);
    return 0;
  }
  for (const Offer& offer : offers_after(command_tree(root), arguments.words))
    std::cout << line_for(shell, offer) << "\n";
  return 0;
}

}  // namespace

std::vector<Offer> offers_after(const CommandNode& root, const std::vector<std::string>& words) {
  const CommandNode* node = &root;
  std::vector<OptionWords> options = root.options;
  std::size_t place = 0;  ///< of the next argument
  const auto option_with_value = [&](const std::string& name) -> const OptionWords* {
    const auto named = [&](const OptionWords& it) {
      return !it.value.empty() &&
             std::find(it.names.begin(), it.names.end(), name) != it.names.end();
    };
    const auto found = std::find_if(options.begin(), options.end(), named);
    return found == options.end() ? nullptr : &*found;
  };
  const OptionWords* due = nullptr;  ///< its value is next
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const std::string& word = words[i];
    const auto below = std::find_if(node->subcommands.begin(), node->subcommands.end(),
                                    [&](const CommandNode& it) { return it.name == word; });
    if (due != nullptr) {
      if (word != "=") due = nullptr;  // --option=value comes from bash as three words
      continue;
    }
    due = option_with_value(word);
    if (due != nullptr || word.starts_with('-') || (i == 0 && word == "help")) continue;
    if (below != node->subcommands.end()) {
      node = &*below;
      options = all_options(*node);
      place = 0;
    } else {
      ++place;
    }
  }
  const std::string& last = words.back();
  const std::size_t equals = last.find('=');
  if (due == nullptr && last.starts_with("--") && equals != std::string::npos)
    due = option_with_value(last.substr(0, equals));
  if (due != nullptr) return offers_for(*due);
  std::vector<Offer> offers;
  if (last.starts_with('-')) {
    for (const OptionWords& option : options)
      for (const std::string& name : option.names) offers.push_back({name, option.help});
  } else if (!node->subcommands.empty()) {
    for (const CommandNode& below : node->subcommands) offers.push_back({below.name, below.help});
  } else if (const std::vector<OptionWords>& arguments = node->arguments; !arguments.empty()) {
    if (place < arguments.size()) return offers_for(arguments[place]);
    if (arguments.back().repeated) return offers_for(arguments.back());
  }
  return offers;
}

void register_completion_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<CompletionArguments>(
      root, program, "completion", "Print a script that completes screed's command line in a shell",
      [&root](const CompletionArguments& given) { return run_completion(given, root); });
  command
      .add_option("SHELL", arguments.shell, "The shell, as in: source <(screed completion bash)")
      ->required()
      ->one_of({"bash", "zsh", "fish"});
  command.add_option(
      "WORD", arguments.words,
      "Behind --, as the script asks: print what may stand for the last of these words");
}

}  // namespace screed
