// The scripts of `screed completion`, run by the shells that they are for, which ask the program.
#include <cstdlib>
#include <set>
#include <sstream>

#include "tests/sitl/program.h"

namespace screed::testing {
namespace {

using Words = std::set<std::string>;

class CompletionProgram : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    write("run.ini", "");
    write("mine", "");  // begins as a choice does
    std::filesystem::create_directory(root_ / "runs");
  }

  static bool has(const std::string& shell) {
    return std::system(("command -v " + shell + " > /dev/null").c_str()) == 0;
  }
  std::string script_for(const std::string& shell) const { return run("completion " + shell).out; }

  /// Runs a script in the folder, with the program on the path; the words that it prints, one a
  /// line. It must say nothing else.
  Words said_by(const std::string& shell, const std::string& script) const {
    write(".script", script);
    const std::string command = "cd '" + root_.string() + "' && HOME=\"$PWD\" PATH='" +
                                std::filesystem::path(program_).parent_path().string() +
                                "':\"$PATH\" " + shell + " .script > .out 2> .err < /dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(read(root_ / ".err"), "");
    std::istringstream lines(read(root_ / ".out"));
    Words words;
    for (std::string line; std::getline(lines, line);) words.insert(line);
    return words;
  }

  /// What bash offers for the last of these words; "" at the end for a new one.
  Words bash(const std::vector<std::string>& typed) const {
    std::string words;
    for (const std::string& word : typed) words += " '" + word + "'";
    return said_by("bash --norc", script_for("bash") + "compopt() { :; }\nCOMP_WORDS=(screed" +
                                      words + ")\nCOMP_CWORD=" + std::to_string(typed.size()) +
                                      "\n_screed\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
  }
  Words fish(const std::string& typed) const {
    Words words;
    const std::string script =
        script_for("fish") + "complete -C 'screed " + typed + "' | string split -f1 \\t; true\n";
    return said_by("fish --no-config", script);
  }
  /// Presses TAB in a terminal of zsh's own; each match that it would add is a line.
  Words zsh(const std::string& typed) const {
    std::filesystem::create_directory(root_ / ".site");
    write(".site/_screed", script_for("zsh"));
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
    write(".inner", inner);
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
    for (const std::string& line : said_by("zsh -f", outer)) {
      const std::size_t begin = line.find('<');
      const std::size_t end = line.find('>');
      if (begin == std::string::npos || end == std::string::npos) continue;
      const std::string word = line.substr(begin + 1, end - begin - 1);
      if (word != "end") words.insert(word);
    }
    return words;
  }
};

TEST_F(CompletionProgram, OfBash) {
  EXPECT_EQ(bash({"se"}), (Words{"send", "session"}));
  EXPECT_EQ(bash({"help", "par"}), (Words{"param", "parity"}));
  EXPECT_EQ(bash({"session", "ex"}), Words{"export"});
  EXPECT_EQ(bash({"param", "get", "spin_rate", "climb_s"}), Words{"climb_speed"});
  EXPECT_EQ(bash({"completion", ""}), (Words{"bash", "fish", "zsh"}));
  EXPECT_EQ(bash({"sim", "--dur"}), Words{"--duration"});
  EXPECT_EQ(bash({"sim", "--hal", "m"}), Words{"mcu"});
  EXPECT_EQ(bash({"sim", "--hal", "=", "m"}), Words{"mcu"});
  EXPECT_EQ(bash({"sim", "--hal", "="}), (Words{"mcu", "native", "surrogate"}));
  EXPECT_EQ(bash({"sim", "run"}), (Words{"run.ini", "runs"}));
  EXPECT_EQ(bash({"manual", "--out", "run"}), Words{"runs"});
  EXPECT_EQ(bash({"sim", "--seed", ""}), Words{""});
  EXPECT_EQ(bash({"param", "--port", "get", "di"}), Words{"diff"});
  EXPECT_EQ(bash({"param", "get", "--rem"}), Words{"--remember"});
}

TEST_F(CompletionProgram, OfFish) {
  if (!has("fish")) GTEST_SKIP() << "fish is missing";
  EXPECT_EQ(fish("se"), (Words{"send", "session"}));
  EXPECT_EQ(fish("session ex"), Words{"export"});
  EXPECT_EQ(fish("sim --dur"), Words{"--duration"});
  EXPECT_EQ(fish("sim --hal m"), Words{"mcu"});
  EXPECT_EQ(fish("sim --hal=m"), Words{"--hal=mcu"});
  EXPECT_EQ(fish("sim run"), (Words{"run.ini", "runs/"}));
  EXPECT_EQ(fish("manual --out run"), Words{"runs/"});
  EXPECT_EQ(fish("manual --out=run"), Words{"--out=runs/"});
  EXPECT_EQ(fish("param --port get di"), Words{"diff"});
  EXPECT_EQ(fish("param set climb_s"), Words{"climb_speed"});
}

TEST_F(CompletionProgram, OfZsh) {
  if (!has("zsh")) GTEST_SKIP() << "zsh is missing";
  EXPECT_EQ(zsh("se"), (Words{"send", "session"}));
  EXPECT_EQ(zsh("session ex"), Words{"export"});
  EXPECT_EQ(zsh("sim --dur"), Words{"--duration"});
  EXPECT_EQ(zsh("sim --hal m"), Words{"mcu"});
  EXPECT_EQ(zsh("sim --hal=m"), Words{"mcu"});
  EXPECT_EQ(zsh("sim run"), (Words{"run.ini", "runs"}));
  EXPECT_EQ(zsh("param --port get di"), Words{"diff"});
  EXPECT_EQ(zsh("param set climb_s"), Words{"climb_speed"});
}

}  // namespace
}  // namespace screed::testing
