// The folder of a run: complete or not there, and never over something else.
#include "host_sim/run/session/run_folder.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <functional>

#include "host_sim/core/errors.h"
#include "host_sim/run/session/session_writer.h"
#include "tests/child_process.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

class RunFolderTest : public ::testing::Test {
 protected:
  TempFolder folder_;
  fs::path base_ = folder_.path();
};

template <class Error>
std::string message_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

void expect_text(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << "message: " << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << "more than one line: " << message;
}

TEST_F(RunFolderTest, AppearsOnlyWithCommit) {
  RunFolder folder = RunFolder::at(base_ / "run");
  write_text(folder.path() / "file", "text");
  EXPECT_EQ(folder.path(), base_ / "run.partial");
  EXPECT_FALSE(fs::exists(base_ / "run"));
  folder.commit();
  EXPECT_EQ(read_text(base_ / "run" / "file"), "text");
  EXPECT_FALSE(fs::exists(base_ / "run.partial"));
}

TEST_F(RunFolderTest, StaysAfterItsObject) {
  { RunFolder::at(base_ / "run").commit(); }
  EXPECT_TRUE(fs::is_directory(base_ / "run"));
}

TEST_F(RunFolderTest, WithoutCommitNothingStays) {
  {
    const RunFolder folder = RunFolder::at(base_ / "a" / "b" / "run");
    fs::create_directory(folder.path() / "sub");
    write_text(folder.path() / "sub" / "file", "text");
  }
  EXPECT_TRUE(fs::is_empty(base_));
}

TEST_F(RunFolderTest, ParentsInUseStayWhenARunFails) {
  {
    const RunFolder folder = RunFolder::at(base_ / "a" / "run");
    write_text(base_ / "a" / "other", "text");
  }
  EXPECT_EQ(read_text(base_ / "a" / "other"), "text");
  EXPECT_FALSE(fs::exists(base_ / "a" / "run.partial"));
}

TEST_F(RunFolderTest, MovedFolderIsRemovedOnce) {
  {
    RunFolder first = RunFolder::at(base_ / "run");
    const RunFolder second = std::move(first);
    EXPECT_TRUE(fs::exists(second.path()));
  }
  EXPECT_TRUE(fs::is_empty(base_));
}

TEST_F(RunFolderTest, AnEmptyFolderMayBeNamed) {
  fs::create_directory(base_ / "run");
  RunFolder folder = RunFolder::at((base_ / "run").string() + "/");
  write_text(folder.path() / "file", "text");
  EXPECT_TRUE(fs::is_empty(base_ / "run"));
  folder.commit();
  EXPECT_EQ(read_text(base_ / "run" / "file"), "text");
}

TEST_F(RunFolderTest, ALinkToAnEmptyFolderMayBeNamed) {
  fs::create_directory(base_ / "real");
  fs::create_directory_symlink(base_ / "real", base_ / "link");
  RunFolder folder = RunFolder::at(base_ / "link");
  write_text(folder.path() / "file", "text");
  folder.commit();
  EXPECT_EQ(read_text(base_ / "real" / "file"), "text");
  EXPECT_TRUE(fs::is_symlink(base_ / "link"));
}

TEST_F(RunFolderTest, AFullFolderIsRefusedAndKept) {
  fs::create_directory(base_ / "run");
  write_text(base_ / "run" / "file", "precious");
  expect_text(message_of<InputError>([&] { RunFolder::at(base_ / "run"); }), "not empty");
  EXPECT_EQ(read_text(base_ / "run" / "file"), "precious");
  EXPECT_FALSE(fs::exists(base_ / "run.partial"));
}

TEST_F(RunFolderTest, AFileOfThatNameIsRefusedAndKept) {
  write_text(base_ / "run", "precious");
  expect_text(message_of<InputError>([&] { RunFolder::at(base_ / "run"); }), "not a folder");
  EXPECT_EQ(read_text(base_ / "run"), "precious");
}

TEST_F(RunFolderTest, AParentThatIsAFileIsRefused) {
  write_text(base_ / "file", "precious");
  const std::string message =
      message_of<InputError>([&] { RunFolder::at(base_ / "file" / "sub" / "run"); });
  expect_text(message, (base_ / "file").string());
  expect_text(message, "not a folder");
  expect_text(message_of<InputError>([&] { RunFolder::numbered(base_ / "file", "hill"); }),
              "not a folder");
  EXPECT_EQ(read_text(base_ / "file"), "precious");
}

TEST_F(RunFolderTest, AnEmptyOrRootNameIsRefused) {
  EXPECT_THROW(RunFolder::at(""), InputError);
  EXPECT_THROW(RunFolder::at("/"), InputError);
  EXPECT_THROW(RunFolder::at(base_ / std::string(300, 'x')), InputError);
}

TEST_F(RunFolderTest, ALeftOverPartialIsReportedAndKept) {
  fs::create_directory(base_ / "run.partial");
  write_text(base_ / "run.partial" / "session.h5", "precious");
  const std::string message = message_of<InputError>([&] { RunFolder::at(base_ / "run"); });
  expect_text(message, (base_ / "run.partial").string());
  expect_text(message, "unfinished");
  EXPECT_EQ(read_text(base_ / "run.partial" / "session.h5"), "precious");
}

TEST_F(RunFolderTest, NumbersAreTheLowestFreeOnes) {
  RunFolder first = RunFolder::numbered(base_ / "out", "hill");
  EXPECT_EQ(first.final_path(), base_ / "out" / "hill-0001");
  first.commit();
  fs::create_directory(base_ / "out" / "hill-0003");
  RunFolder second = RunFolder::numbered(base_ / "out", "hill");
  EXPECT_EQ(second.final_path(), base_ / "out" / "hill-0002");
  EXPECT_TRUE(second.leftovers().empty());
  const RunFolder third = RunFolder::numbered(base_ / "out", "hill");
  EXPECT_EQ(third.final_path(), base_ / "out" / "hill-0004");
  EXPECT_EQ(RunFolder::numbered(base_ / "out", "pit").final_path(), base_ / "out" / "pit-0001");
}

TEST_F(RunFolderTest, ARunThatGoesOnIsNotLeftOver) {
  fs::create_directories(base_ / "hill-0001.partial");
  SessionInfo info;
  const SessionWriter running(base_ / "hill-0001.partial" / "session.h5", info);
  const RunFolder folder = RunFolder::numbered(base_, "hill");
  EXPECT_EQ(folder.final_path(), base_ / "hill-0002");
  EXPECT_TRUE(folder.leftovers().empty());
  std::string error = "none";
  try {
    RunFolder::at(base_ / "hill-0001");
  } catch (const InputError& it) {
    error = it.what();
  }
  EXPECT_EQ(error, (base_ / "hill-0001.partial").string() +
                       ": a run is being recorded there; wait for its end or name another folder");
}

TEST_F(RunFolderTest, NumbersPassOverLeftOversAndNameThem) {
  fs::create_directories(base_ / "hill-0001.partial");
  write_text(base_ / "hill-0001.partial" / "session.h5", "precious");
  RunFolder folder = RunFolder::numbered(base_, "hill");
  EXPECT_EQ(folder.final_path(), base_ / "hill-0002");
  ASSERT_EQ(folder.leftovers().size(), 1U);
  EXPECT_EQ(folder.leftovers().front(), base_ / "hill-0001.partial");
  folder.commit();
  EXPECT_EQ(read_text(base_ / "hill-0001.partial" / "session.h5"), "precious");
}

TEST_F(RunFolderTest, AnExperimentNameMustBeAFileName) {
  EXPECT_THROW(RunFolder::numbered(base_, "../hill"), InputError);
  EXPECT_THROW(RunFolder::numbered(base_, ""), InputError);
  EXPECT_TRUE(fs::is_empty(base_));
}

TEST_F(RunFolderTest, ACompleteRunIsKeptWhenItsNameWasTakenMeanwhile) {
  {
    RunFolder folder = RunFolder::at(base_ / "run");
    write_text(folder.path() / "file", "complete");
    fs::create_directory(base_ / "run");
    write_text(base_ / "run" / "other", "precious");
    const std::string message = message_of<RunError>([&] { folder.commit(); });
    expect_text(message, (base_ / "run.partial").string());
  }
  EXPECT_EQ(read_text(base_ / "run.partial" / "file"), "complete");
  EXPECT_EQ(read_text(base_ / "run" / "other"), "precious");
}

// In a child process, since permissions do not bind root.
TEST_F(RunFolderTest, AnUnwritableParentIsARunError) {
  fs::permissions(base_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                             fs::perms::others_exec);
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    constexpr uid_t kNobody = 65534;
    if (geteuid() == 0 && seteuid(kNobody) != 0) return "cannot become nobody";
    const std::string message = message_of<RunError>([&] { RunFolder::at(base_ / "run"); });
    const bool named = message.find((base_ / "run").string()) != std::string::npos;
    if (!named || message.find("Permission denied") == std::string::npos) return "said: " + message;
    return "";
  }));
  fs::permissions(base_, fs::perms::owner_all);
}

}  // namespace
}  // namespace screed
