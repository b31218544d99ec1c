// --help: its form, and that of every subcommand.
#include "tools/command_line/help.h"

#include <gtest/gtest.h>

#include <functional>
#include <regex>

#include "tools/screed/cli/command_line.h"

namespace screed {
namespace {

TEST(HelpFormat, SaysTypesRangesAndDefaultsInWords) {
  Command app("A program that does something", "prog");
  double share = 0.5;
  int count = 3;
  std::string out = "here";
  std::string text;
  std::vector<std::string> files;
  std::string mode;
  bool quiet = false;
  bool pictures = true;
  std::vector<std::string> keys;
  app.add_option("FILE", files, "Input files")->required();
  Option* first = app.add_option("--share", share, "The share")->range(0.0, 1.0)->show_default();
  app.add_option("-n,--count", count, "How many")->positive();
  app.add_option("--out", out, "Output folder")->type_name("FOLDER")->show_default();
  app.add_option("--colour", text, "The colour (default: black)")->excludes(first);
  app.add_option("--mode", mode, "The mode")->one_of({"fast", "slow"})->required();
  app.add_option("--speed", mode, "The speed: low or high")->one_of({"low", "high"});
  app.add_option("--key", keys, "A key; may be repeated");
  app.add_flag("--quiet", quiet, "Say nothing")->needs(first);
  app.add_flag("!--no-pictures", pictures, "Draw nothing");
  EXPECT_EQ(help_page(app),
            "A program that does something\n"
            "\n"
            "Usage: prog [OPTIONS] FILE...\n"
            "\n"
            "Arguments:\n"
            "  FILE...                 Input files\n"
            "\n"
            "Options:\n"
            "  -h, --help              Print this help message and exit\n"
            "  --share NUMBER          The share (0 to 1; not with --colour; default: 0.5)\n"
            "  -n, --count INTEGER     How many (more than 0)\n"
            "  --out FOLDER            Output folder (default: here)\n"
            "  --colour COLOUR         The colour (not with --share; default: black)\n"
            "  --mode MODE             The mode (fast, slow; required)\n"
            "  --speed SPEED           The speed: low or high\n"
            "  --key KEY               A key; may be repeated\n"
            "  --quiet                 Say nothing (needs --share)\n"
            "  --no-pictures           Draw nothing\n");
}

TEST(HelpFormat, WrapsAndListsSubcommands) {
  Command app("A program", "prog");
  Command* group = app.add_subcommand("group", "A group");
  bool flag = false;
  group->add_flag("--a-very-long-name-of-an-option", flag,
                  "A description of so many words that they do not go into one line of a page");
  Command* below = group->add_subcommand("below", "Belongs to the group");
  below->fallthrough();
  EXPECT_EQ(help_page(*group),
            "A group\n"
            "\n"
            "Usage: prog group [OPTIONS] SUBCOMMAND\n"
            "\n"
            "Options:\n"
            "  -h, --help              Print this help message and exit\n"
            "  --a-very-long-name-of-an-option\n"
            "                          A description of so many words that they do not go\n"
            "                          into one line of a page\n"
            "\n"
            "Subcommands:\n"
            "  below                   Belongs to the group\n"
            "\n"
            "prog group SUBCOMMAND --help describes each.\n");
  EXPECT_NE(help_page(*below).find("Options of prog group:\n"
                                   "  --a-very-long-name-of-an-option\n"),
            std::string::npos)
      << help_page(*below);
  EXPECT_EQ(help_page(app).find("--a-very"), std::string::npos);
}

/// Every page of the program, with its command line.
void for_each_page(const std::function<void(const std::string& path, const Command&)>& visit) {
  CommandLine line("1.2.3", "screed 1.2.3");
  const std::function<void(const Command&)> walk = [&](const Command& at) {
    visit(at.path(), at);
    for (const auto& below : at.subcommands()) walk(*below);
  };
  walk(line.app);
}

TEST(Help, OfNoSubcommandShowsTheParsersOwnWords) {
  static const std::regex noise(
      "\\{|\\}|\\bU?INT\\b|\\bFLOAT\\b|\\bTEXT\\b|BOOLEAN|POSITIVE|Excludes:|Needs:|REQUIRED|=\\[|"
      "[0-9]\\.\\.[0-9]| \\.\\.\\.|18446744073709551615");
  int pages = 0;
  for_each_page([&](const std::string& path, const Command& app) {
    ++pages;
    const std::string help = help_page(app);
    std::smatch found;
    EXPECT_FALSE(std::regex_search(help, found, noise))
        << path << " --help shows '" << found.str() << "':\n"
        << help;
    EXPECT_NE(help.find("\nUsage: " + path), std::string::npos) << help;
  });
  EXPECT_GT(pages, 50);
}

TEST(Help, FitsIntoEightyColumns) {
  for_each_page([](const std::string& path, const Command& app) {
    std::istringstream lines(help_page(app));
    for (std::string line; std::getline(lines, line);) {
      EXPECT_LE(line.size(), 80U) << path << " --help: " << line;
      EXPECT_TRUE(line.empty() || line.back() != ' ') << path << " --help: '" << line << "'";
    }
  });
}

TEST(Help, DescribesEveryOptionAndSaysNoDefaultTwice) {
  for_each_page([](const std::string& path, const Command& app) {
    EXPECT_FALSE(app.help().empty()) << path;
    for (const auto& option : app.options()) {
      const OptionWords words = words_of(*option);
      const std::string text = words.help + " " + details(words);
      EXPECT_FALSE(words.help.empty()) << path << " " << words.names.front();
      EXPECT_EQ(text.find("efault: "), text.rfind("efault: "))
          << path << " " << words.names.front() << ": " << text;
    }
  });
}

}  // namespace
}  // namespace screed
