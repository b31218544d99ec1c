// The scripts of `screed completion`, run by the shells that they are for.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <sstream>

#include "tests/temp_folder.h"
#include "tools/screed/cli/command_line.h"
#include "tools/screed/manual/shell_completion.h"

namespace screed {
namespace {

using Words = std::set<std::string>;

class Completion : public ::testing::Test {
 protected:
  Completion() : root_(command_tree(line_.app)) {
    write_text(folder_.path() / "run.ini", "");
    write_text(folder_.path() / "mine", "");  // begins as a choice does
    std::filesystem::create_directory(folder_.path() / "runs");
  }

  static bool has(const std::string& shell) {
    return std::system(("command -v " + shell + " > /dev/null").c_str()) == 0;
  }

  /// Runs a script in the folder; the words that it prints, one a line. It must say nothing else.
  Words run(const std::string& shell, const std::string& script) const {
    const std::filesystem::path& folder = folder_.path();
    write_text(folder / ".script", script);
    const std::string command = "cd '" + folder.string() + "' && HOME=\"$PWD\" " + shell +
                                " .script > .out 2> .err < /dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(read_text(folder / ".err"), "");
    std::istringstream lines(read_text(folder / ".out"));
    Words words;
    for (std::string line; std::getline(lines, line);) words.insert(line);
    return words;
  }

  /// What bash offers for the last of these words; "" at the end for a new one.
  Words bash(const std::vector<std::string>& typed) const {
    std::string words;
    for (const std::string& word : typed) words += " '" + word + "'";
    return run("bash --norc", bash_completion(root_) + "compopt() { :; }\nCOMP_WORDS=(screed" +
                                  words + ")\nCOMP_CWORD=" + std::to_string(typed.size()) +
                                  "\n_screed\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
  }
  Words fish(const std::string& typed) const {
    Words words;
    const std::string script = fish_completion(root_) + "complete -C 'screed " + typed +
                               "' | string split -f1 \\t; true\n";
    return run("fish --no-config", script);
  }
  /// Presses TAB in a terminal of zsh's own; each match that it would add is a line.
  Words zsh(const std::string& typed) const {
    std::filesystem::create_directory(folder_.path() / ".site");
    write_text(folder_.path() / ".site" / "_screed", zsh_completion(root_));
    const std::string inner = R"(PROMPT=
fpath=($PWD/.site $fpath)
autoload -Uz compinit && compinit -u -D
begin() { print -r -- '<begin>' }
finish() { print -r -- '<end>'; exit }
compprefuncs=(begin)
comppostfuncs=(finish)
compadd() {
  if [[ ${@[1,(i)(-|--)]} == *-(O|A|D)\ * ]]; then builtin compadd "$@"; return; fi
  local -a hits
  builtin compadd -A hits "$@"
  for hit in $hits; do print -r -- "<$hit>"; done
}
bindkey '^I' complete-word
print -r -- '<ready>'
)";
    write_text(folder_.path() / ".inner", inner);
    const std::string outer = R"(zmodload zsh/zpty
zpty terminal zsh -f -i
zpty -w terminal 'source ./.inner'
zpty -r terminal line $'*<ready>*'
zpty -w -n terminal 'screed )" +
                              typed + R"('$'\t'
zpty -r terminal line $'*<end>*'
print -r -- ${line#*<begin>}
zpty -d terminal
)";
    Words words;
    for (const std::string& line : run("zsh -f", outer)) {
      const std::size_t begin = line.find('<');
      const std::size_t end = line.find('>');
      if (begin == std::string::npos || end == std::string::npos) continue;
      const std::string word = line.substr(begin + 1, end - begin - 1);
      if (word != "end") words.insert(word);
    }
    return words;
  }

  const TempFolder folder_;
  CommandLine line_{"1.2.3", "screed 1.2.3"};
  const CommandNode root_;
};

Words names_of(const CommandNode& node) {
  Words names;
  for (const CommandNode& below : node.subcommands) names.insert(below.name);
  return names;
}

TEST_F(Completion, OfBashFollowsTheCommandTree) {
  EXPECT_EQ(bash({""}), names_of(root_));
  EXPECT_EQ(bash({"se"}), (Words{"send", "session"}));
  EXPECT_EQ(bash({"help", "par"}), (Words{"param", "parity"}));
  EXPECT_EQ(bash({"session", "ex"}), Words{"export"});
  EXPECT_EQ(bash({"param", "set", "climb_s"}), Words{"climb_speed"});
  EXPECT_EQ(bash({"param", "get", "spin_rate", "climb_s"}), Words{"climb_speed"});
  EXPECT_EQ(bash({"completion", ""}), (Words{"bash", "fish", "zsh"}));
}

TEST_F(Completion, OfBashKnowsOptionsAndTheirValues) {
  EXPECT_EQ(bash({"sim", "--dur"}), Words{"--duration"});
  EXPECT_EQ(bash({"sim", "--hal", "m"}), Words{"mcu"});
  EXPECT_EQ(bash({"sim", "--hal", "=", "m"}), Words{"mcu"});
  EXPECT_EQ(bash({"sim", "--hal", "="}), (Words{"mcu", "native", "surrogate"}));
  EXPECT_EQ(bash({"sim", "run"}), (Words{"run.ini", "runs"}));
  EXPECT_EQ(bash({"manual", "--out", "run"}), Words{"runs"});
  EXPECT_EQ(bash({"sim", "--seed", ""}), Words{""});
  // A value is no subcommand, and the options of a group hold for those below it.
  EXPECT_EQ(bash({"param", "--port", "get", "di"}), Words{"diff"});
  EXPECT_EQ(bash({"param", "get", "--rem"}), Words{"--remember"});
}

/// Every path of the tree is offered step by step, every option where it is taken.
TEST_F(Completion, OfBashIsComplete) {
  std::string script = bash_completion(root_) + "compopt() { :; }\n";
  std::set<std::string> expected;
  for_each_node(root_, [&](const CommandNode& node) {
    const auto ask = [&](const std::string& word) {
      std::string words = node.path + " " + word;
      script += "COMP_WORDS=(" + words +
                "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _screed; "
                "printf '" +
                node.path + " %s\\n' \"${COMPREPLY[@]}\"\n";
    };
    for (const OptionWords& option : all_options(node)) {
      for (const std::string& name : option.names) expected.insert(node.path + " " + name);
    }
    ask("-");
    if (node.subcommands.empty()) return;
    ask("''");
    for (const CommandNode& below : node.subcommands) expected.insert(below.path);
  });
  EXPECT_EQ(run("bash --norc", script), expected);
  EXPECT_GT(expected.size(), 400U);
}

TEST_F(Completion, OfFishFollowsTheCommandTree) {
  if (!has("fish")) GTEST_SKIP() << "fish is missing";
  EXPECT_EQ(fish("se"), (Words{"send", "session"}));
  EXPECT_EQ(fish("session ex"), Words{"export"});
  EXPECT_EQ(fish("sim --dur"), Words{"--duration"});
  EXPECT_EQ(fish("sim --hal m"), Words{"mcu"});
  EXPECT_EQ(fish("param --port get di"), Words{"diff"});
  EXPECT_EQ(fish("param set climb_s"), Words{"climb_speed"});
}

TEST_F(Completion, OfZshFollowsTheCommandTree) {
  if (!has("zsh")) GTEST_SKIP() << "zsh is missing";
  EXPECT_EQ(zsh("se"), (Words{"send", "session"}));
  EXPECT_EQ(zsh("session ex"), Words{"export"});
  EXPECT_EQ(zsh("sim --dur"), Words{"--duration"});
  EXPECT_EQ(zsh("sim --hal m"), Words{"mcu"});
  EXPECT_EQ(zsh("param --port get di"), Words{"diff"});
  EXPECT_EQ(zsh("param set climb_s"), Words{"climb_speed"});
}

}  // namespace
}  // namespace screed
