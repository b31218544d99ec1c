// tools/build/version.sh: number, commit and date, with git, without it, and in an archive.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "host_sim/core/child_process.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

class Version : public ::testing::Test {
 protected:
  Version() {
    const fs::path tools = root_ / "tools" / "build";
    fs::create_directories(tools);
    for (const char* file : {"version.sh", "commit.txt", ".gitattributes"})
      fs::copy_file(fs::path("tools/build") / file, tools / file);
    write_text(root_ / "CHANGELOG.md",
               "# Changelog\n\n## [Unreleased]\n\n- [1.0.0] - 2001-01-01 is no heading\n\n"
               "## [2.10.3] - 2026-01-31\n\n## [2.9.0] - 2025-12-01\n");
  }

  /// Runs a shell line in a folder, without the user's own git configuration; what it prints.
  std::string say(const std::string& line, const fs::path& folder, int expected_status = 0) const {
    const std::string git =
        "export GIT_CONFIG_GLOBAL=/dev/null GIT_CONFIG_NOSYSTEM=1 GIT_AUTHOR_NAME=a "
        "GIT_AUTHOR_EMAIL=a@b GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a@b "
        "GIT_COMMITTER_DATE='2026-03-04T12:00:00+00:00'; ";
    const ShellOutput said =
        shell_output(git + "cd '" + folder.string() + "' && { " + line + "; } 2>&1");
    EXPECT_EQ(said.exit_code == 0, expected_status == 0) << said.text;
    return said.text;
  }
  void commit() const { say("git init -q . && git add -A && git commit -q -m first", root_); }

  const TempFolder folder_;
  const fs::path root_ = folder_.path() / "sources";
};

constexpr const char* kScript = "tools/build/version.sh";

TEST_F(Version, WithoutGitIsThatOfTheNewestRelease) {
  EXPECT_EQ(say(kScript, root_), "2.10.3 unknown 2026-01-31\n");
}

TEST_F(Version, WithGitHasCommitAndDate) {
  commit();
  const std::string text = say(kScript, root_);
  EXPECT_TRUE(std::regex_match(text, std::regex("2\\.10\\.3 [0-9a-f]{7,} 2026-03-04\n"))) << text;
  EXPECT_EQ(say("git rev-parse --short HEAD", root_), text.substr(7, text.rfind(' ') - 7) + "\n");
  // Wherever it is called from, and whoever owns the tree.
  EXPECT_EQ(say((root_ / kScript).string(), folder_.path()), text);
  EXPECT_EQ(say(std::string("GIT_TEST_ASSUME_DIFFERENT_OWNER=1 ") + kScript, root_), text);
  write_text(root_ / "CHANGELOG.md", "## [3.0.0] - 2026-05-05\n");
  EXPECT_EQ(say(kScript, root_),
            "3.0.0" + text.substr(6, text.rfind(' ') - 6) + "-dirty 2026-03-04\n");
}

TEST_F(Version, AnArchiveKnowsItsCommit) {
  commit();
  const std::string text = say(kScript, root_);
  say("mkdir ../archive && git archive HEAD | tar -x -C ../archive", root_);
  EXPECT_EQ(say(kScript, folder_.path() / "archive"), text);
}

TEST_F(Version, OfAnotherRepositoryAroundItIsNotTaken) {
  say("git init -q . && git commit -q --allow-empty -m other", folder_.path());
  EXPECT_EQ(say(kScript, root_), "2.10.3 unknown 2026-01-31\n");
}

TEST_F(Version, AChangelogWithoutAReleaseIsRefused) {
  write_text(root_ / "CHANGELOG.md", "## [Unreleased]\n");
  EXPECT_NE(say(kScript, root_, 1).find("CHANGELOG.md: no release"), std::string::npos);
}

}  // namespace
}  // namespace screed
