// What a program says of a command line that it does not understand, and its help.
#include "tools/command_line/program.h"

#include <gtest/gtest.h>

namespace screed {
namespace {

struct Said {
  int exit_code;
  std::string text;  ///< on both streams
};

/// A program with `sim`, and `session` with `info` and `export`, is called with these words.
Said call(std::vector<std::string> words) {
  Command app("A program", "prog");
  double duration = 0.0;
  app.add_subcommand("sim", "Run it")->add_option("--duration", duration, "How long");
  Command* session = app.add_subcommand("session", "Look at it");
  session->add_subcommand("info", "Show it");
  session->add_subcommand("export", "Write it");
  words.insert(words.begin(), "prog");
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) argv.push_back(word.data());
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  const int code = run_program(app, static_cast<int>(argv.size()), argv.data(), [] { return 0; });
  const std::string error = ::testing::internal::GetCapturedStderr();
  return {code, error + ::testing::internal::GetCapturedStdout()};
}

TEST(RunProgram, NamesTheSubcommandThatWasMeant) {
  const Said said = call({"simm", "--duration", "1"});
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_EQ(said.text, "prog: 'simm' is no subcommand; did you mean sim? (see prog --help)\n");
  EXPECT_EQ(call({"session", "exprot"}).text,
            "prog: 'exprot' is no subcommand; did you mean export? (see prog session --help)\n");
}

TEST(RunProgram, NamesTheOptionThatWasMeant) {
  const Said said = call({"sim", "--druation=3"});
  EXPECT_EQ(said.exit_code, 2);
  EXPECT_EQ(said.text,
            "prog: '--druation' is no option; did you mean --duration? (see prog sim --help)\n");
}

TEST(RunProgram, NamesAnUnknownOptionWhereASubcommandIsMissing) {
  EXPECT_EQ(call({"--nosuch"}).text, "prog: '--nosuch' is no option (see prog --help)\n");
  EXPECT_EQ(call({"-x"}).text, "prog: '-x' is no option (see prog --help)\n");
  EXPECT_EQ(call({"session", "--nosuch", "info"}).text,
            "prog: '--nosuch' is no option (see prog session info --help)\n");
  EXPECT_EQ(call({"--nosuch"}).exit_code, 2);
}

TEST(RunProgram, SuggestsNothingThatIsFarAway) {
  EXPECT_EQ(call({"paint"}).text, "prog: 'paint' is no subcommand (see prog --help)\n");
  EXPECT_EQ(call({}).text.find("did you mean"), std::string::npos);
  EXPECT_EQ(call({"sim", "--colour"}).text.find("did you mean"), std::string::npos);
}

TEST(RunProgram, HelpIsASubcommandToo) {
  EXPECT_EQ(call({"help"}).exit_code, 0);
  EXPECT_EQ(call({"help"}).text, call({"--help"}).text);
  EXPECT_EQ(call({"help", "session", "export"}).text, call({"session", "export", "--help"}).text);
  EXPECT_NE(call({"help", "sim"}).text.find("How long"), std::string::npos);
}

TEST(RunProgram, HelpOfAWordThatIsNoSubcommandIsWrongInput) {
  const std::string meant = "prog: 'simm' is no subcommand; did you mean sim? (see prog --help)\n";
  EXPECT_EQ(call({"help", "simm"}).text, meant);
  EXPECT_EQ(call({"simm", "--help"}).text, meant);
  EXPECT_EQ(call({"simm", "--help"}).exit_code, 2);
  EXPECT_EQ(call({"help", "session", "exprot"}).text, call({"session", "exprot"}).text);
}

TEST(EditDistance, CountsLettersPutInLeftOutChangedAndSwapped) {
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("ca", "abc"), 3U);  // the restricted distance: 2 without the restriction
  EXPECT_EQ(edit_distance("exprot", "export"), 1U);
  EXPECT_EQ(edit_distance("same", "same"), 0U);
}

TEST(NearestWord, IsTheFirstOfEqualsWithinAThirdOfItsLetters) {
  EXPECT_EQ(nearest_word("rat", {"cat", "bat"}), "cat");
  EXPECT_EQ(nearest_word("bet", {"cat", "bat"}), "bat");
  EXPECT_EQ(nearest_word("terain", {"terrain", "train"}), "terrain");
  EXPECT_EQ(nearest_word("xyz", {"cat", "bat"}), "");
}

}  // namespace
}  // namespace screed
