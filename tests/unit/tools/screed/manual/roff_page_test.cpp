// The man pages, read by man itself.
#include "tools/screed/manual/roff_page.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <functional>

#include "tests/temp_folder.h"
#include "tools/screed/cli/command_line.h"

namespace screed {
namespace {

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
