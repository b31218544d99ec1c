// What the program says of its command line: what may stand next, as shells ask it, and man pages.
#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>
#include <set>

#include "tests/temp_folder.h"
#include "tools/screed/cli/command_line.h"
#include "tools/screed/manual/manual.h"

namespace screed {
namespace {

using Words = std::set<std::string>;

class Completion : public ::testing::Test {
 protected:
  /// What is offered behind these words; the last of them, which a shell compares, does not narrow
  /// it.
  Words offered(const std::vector<std::string>& typed) const {
    Words words;
    for (const Offer& offer : offers_after(root_, typed)) words.insert(offer.word);
    return words;
  }

  CommandLine line_{"1.2.3", "screed 1.2.3"};
  const CommandNode root_ = command_tree(line_.app);
};

Words names_of(const CommandNode& node) {
  Words names;
  for (const CommandNode& below : node.subcommands) names.insert(below.name);
  return names;
}

/// Every path of the tree is offered step by step, every option where it is taken, with its help.
TEST_F(Completion, OffersAllThatTheCommandLineHas) {
  std::size_t count = 0;
  const std::function<void(const CommandNode&, std::vector<std::string>)> check =
      [&](const CommandNode& node, std::vector<std::string> path) {
        path.emplace_back("-");
        std::vector<Offer> expected;
        for (const std::vector<OptionWords>* options : {&node.options, &node.inherited}) {
          for (const OptionWords& option : *options)
            for (const std::string& name : option.names) expected.push_back({name, option.help});
        }
        EXPECT_EQ(offers_after(root_, path), expected) << node.path;
        count += expected.size();
        path.back() = "";
        if (node.subcommands.empty()) return;
        EXPECT_EQ(offered(path), names_of(node)) << node.path;
        for (const CommandNode& below : node.subcommands) {
          path.back() = below.name;
          check(below, path);
        }
      };
  check(root_, {});
  EXPECT_GT(count, 400U);
}

TEST_F(Completion, KnowsArgumentsAndValues) {
  const Words files = {"/files"};
  const Words ways = {"mcu", "native", "surrogate"};
  EXPECT_EQ(offered({"help", ""}), names_of(root_));
  EXPECT_EQ(offered({"completion", ""}), (Words{"bash", "fish", "zsh"}));
  EXPECT_TRUE(offered({"param", "set", "climb_s"}).contains("climb_speed"));
  EXPECT_TRUE(offered({"param", "get", "spin_rate", ""}).contains("climb_speed"));
  EXPECT_EQ(offered({"sim", "--hal", "m"}), ways);
  EXPECT_EQ(offered({"sim", "--hal", "=", "m"}), ways);
  EXPECT_EQ(offered({"sim", "--hal", "="}), ways);
  EXPECT_EQ(offered({"sim", "--hal=m"}), ways);
  EXPECT_EQ(offered({"sim", "--hal=mcu", "run"}), files);
  EXPECT_EQ(offered({"sim", "one.ini", "run"}), files);
  EXPECT_EQ(offered({"manual", "--out", "run"}), Words{"/folders"});
  EXPECT_EQ(offered({"sim", "--seed", ""}), Words{});
  // A value is no subcommand, and the options of a group hold for those below it.
  EXPECT_TRUE(offered({"param", "--port", "get", "di"}).contains("diff"));
  EXPECT_TRUE(offered({"param", "get", "--rem"}).contains("--remember"));
}

// ---- man pages, read by man itself ----

class RoffPage : public ::testing::Test {
 protected:
  /// The page as a reader sees it. man must have nothing to warn about.
  std::string shown(const std::string& page) const {
    const std::filesystem::path& folder = folder_.path();
    write_text(folder / "page.1", page);
    const std::string command =
        "cd '" + folder.string() +
        "' && LC_ALL=C.UTF-8 MANWIDTH=80 man --warnings -P cat -l page.1 > out "
        "2> err";
    EXPECT_EQ(std::system(command.c_str()), 0);
    EXPECT_EQ(read_text(folder / "err"), "") << page;
    return read_text(folder / "out");
  }

  const TempFolder folder_;
  CommandLine line_{"1.2.3", "screed 1.2.3"};
  const CommandNode root_ = command_tree(line_.app);
};

TEST_F(RoffPage, OfTheProgramListsItsSubcommands) {
  if (std::system("command -v man > /dev/null") != 0) GTEST_SKIP() << "man is missing";
  const std::string page = shown(roff_page(root_, "1.2.3"));
  EXPECT_NE(page.find("SCREED(1)"), std::string::npos) << page;
  EXPECT_NE(page.find("screed 1.2.3"), std::string::npos);
  for (const CommandNode& below : root_.subcommands)
    EXPECT_NE(page.find("\n       " + below.name), std::string::npos) << below.name;
}

TEST_F(RoffPage, OfASubcommandHasEveryOptionOfItAndThoseBelow) {
  if (std::system("command -v man > /dev/null") != 0) GTEST_SKIP() << "man is missing";
  for (const CommandNode& below : root_.subcommands) {
    const std::string page = shown(roff_page(root_, below, "1.2.3"));
    const std::function<void(const CommandNode&)> check = [&](const CommandNode& node) {
      for (const OptionWords& option : node.options) {
        for (const std::string& name : option.names)
          EXPECT_NE(page.find(name), std::string::npos) << node.path << " " << name;
      }
      for (const CommandNode& next : node.subcommands) {
        EXPECT_NE(page.find("   " + next.path + "\n"), std::string::npos) << next.path;
        check(next);
      }
    };
    check(below);
  }
}

TEST_F(RoffPage, HasSectionsForThoseBelowAndDashesThatStayDashes) {
  for (const CommandNode& below : root_.subcommands) {
    if (below.name != "session") continue;
    const std::string page = roff_page(root_, below, "1.2.3");
    EXPECT_NE(page.find("\n.SS \"screed session export\"\n"), std::string::npos) << page;
    EXPECT_NE(page.find("\\fB\\-\\-heights\\fR"), std::string::npos) << page;
    EXPECT_EQ(page.find("--"), std::string::npos) << page;
    return;
  }
  FAIL() << "there is no screed session";
}

TEST_F(RoffPage, TextIsNoMarkup) {
  if (std::system("command -v man > /dev/null") != 0) GTEST_SKIP() << "man is missing";
  CommandNode odd;
  odd.name = odd.path = "odd";
  odd.help = ".SH is 'no' heading, \\fBnot bold\\fR, --as-it-is";
  const std::string page = shown(roff_page(odd, "1"));
  EXPECT_NE(page.find(".SH is 'no' heading, \\fBnot bold\\fR, --as-it-is"), std::string::npos)
      << page;
}

}  // namespace
}  // namespace screed
