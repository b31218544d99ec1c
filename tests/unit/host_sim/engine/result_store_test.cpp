// Result files: what is written is found, what is damaged is not.
#include "host_sim/engine/result_store.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;

StoredResult done(const std::string& id, const std::string& result) {
  return {id, ResultStatus::kDone, result, R"({"host":"here"})"};
}
StoredResult failed(const std::string& id) {
  return {id, ResultStatus::kFailed, R"({"error":"crash"})", "{}"};
}

class ResultStore : public ::testing::Test {
 protected:
  fs::path results() const { return folder_.path() / "results"; }
  /// A file with these results; its path.
  fs::path write(const std::vector<StoredResult>& all) const {
    ResultWriter writer(results());
    for (const StoredResult& result : all) writer.append(result);
    return writer.path();
  }
  ResultIndex index() const { return ResultIndex(results()); }

 private:
  const TempFolder folder_;
};

TEST_F(ResultStore, IsEmptyWithoutFolder) {
  EXPECT_TRUE(index().places().empty());
}

TEST_F(ResultStore, FindsWhatWasWritten) {
  write({done("a", R"({"x":1.5})"), failed("b")});
  write({done("c", R"({"text":"two words"})")});
  const ResultIndex found = index();
  EXPECT_EQ(found.places().size(), 3U);
  EXPECT_TRUE(found.done("a"));
  EXPECT_TRUE(found.failed("b"));
  EXPECT_TRUE(found.done("c"));
  EXPECT_FALSE(found.done("d"));
  EXPECT_FALSE(found.failed("d"));
  EXPECT_EQ(found.read("a").result, R"({"x":1.5})");
  EXPECT_EQ(found.read("a").provenance, R"({"host":"here"})");
  EXPECT_EQ(found.read("c").result, R"({"text":"two words"})");
  EXPECT_TRUE(found.damaged().empty());
}

TEST_F(ResultStore, ADoneRunCountsBeforeAFailedOne) {
  write({failed("a"), failed("a"), done("a", "{}"), failed("a")});
  EXPECT_TRUE(index().done("a"));
  EXPECT_FALSE(index().failed("a"));
  EXPECT_EQ(index().failures("a"), 3U);
}

TEST_F(ResultStore, TheSameResultTwiceIsOne) {
  write({done("a", "{}")});
  write({done("a", "{}")});
  EXPECT_TRUE(index().done("a"));
}

TEST_F(ResultStore, RefusesTwoDifferentResultsOfARun) {
  write({done("a", R"({"x":1})")});
  write({done("a", R"({"x":2})")});
  EXPECT_THROW(index(), InputError);
}

TEST_F(ResultStore, WithoutResultsThereIsNoFile) {
  EXPECT_FALSE(fs::exists(write({})));
}

TEST_F(ResultStore, HalfALineIsNoResult) {
  const fs::path file = write({done("a", "{}"), done("b", "{}")});
  const std::string whole = read_text(file);
  const size_t first = whole.find('\n') + 1;
  for (size_t kept = 0; kept < whole.size(); ++kept) {
    write_text(file, whole.substr(0, kept));
    const ResultIndex found = index();
    EXPECT_EQ(found.done("a"), kept >= first) << kept;
    EXPECT_FALSE(found.done("b")) << kept;
    EXPECT_TRUE(found.damaged().empty()) << kept;
  }
}

TEST_F(ResultStore, AnyWrongByteIsNoticed) {
  const fs::path file = write({done("a", R"({"x":1})"), done("b", "{}")});
  const std::string whole = read_text(file);
  const size_t first = whole.find('\n');
  for (size_t i = 0; i < first; ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 1);
    write_text(file, damaged);
    const ResultIndex found = index();
    EXPECT_FALSE(found.done("a")) << i;
    EXPECT_TRUE(found.done("b")) << i;
    EXPECT_FALSE(found.damaged().empty()) << i;
  }
  write_text(file, std::string(whole.size(), '\0') + "\n");
  ASSERT_EQ(index().damaged().size(), 1U);
  EXPECT_NE(index().damaged().front().find(file.string() + ":1"), std::string::npos);
}

/// Files of this process end at so many bytes while it lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST_F(ResultStore, AFullDiskKeepsWhatIsThere) {
  ResultWriter writer(results());
  writer.append(done("a", "{}"));
  const auto size = fs::file_size(writer.path());
  {
    const FileSizeLimit full(size + 10);
    EXPECT_THROW(writer.append(done("b", "{}")), RunError);
  }
  EXPECT_EQ(fs::file_size(writer.path()), size);
  writer.append(done("c", "{}"));
  const ResultIndex found = index();
  EXPECT_TRUE(found.done("a"));
  EXPECT_FALSE(found.done("b"));
  EXPECT_TRUE(found.done("c"));
}

TEST_F(ResultStore, RefusesAFolderThatCannotBeMade) {
  write_text(results(), "a file");
  EXPECT_THROW(ResultWriter{results()}, RunError);
}

}  // namespace
}  // namespace screed
