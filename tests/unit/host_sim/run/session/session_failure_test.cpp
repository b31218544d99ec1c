// What goes wrong while a session is being written: full disks, killed programs.
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>

#include "tests/child_process.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {
namespace {

TEST_F(SessionTest, AnExistingFileIsNotOverwritten) {
  write_text(file_, "precious");
  expect_line(message_of<RunError>([&] { write_run(file_, random_run(1)); }), file_, "exists");
  EXPECT_EQ(read_text(file_), "precious");
}

TEST_F(SessionTest, AFolderThatIsNotThereIsARunError) {
  const fs::path file = base_ / "missing" / "session.h5";
  expect_line(message_of<RunError>([&] { write_run(file, random_run(1)); }), file,
              "No such file or directory");
}

TEST_F(SessionTest, AFolderThatIsNotWritableIsARunError) {
  fs::permissions(base_, fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read |
                             fs::perms::others_exec);
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    constexpr uid_t kNobody = 65534;  // permissions do not bind root
    if (geteuid() == 0 && seteuid(kNobody) != 0) return "cannot become another user";
    const std::string message = message_of<RunError>([&] { write_run(file_, random_run(1)); });
    return message.find("Permission denied") == std::string::npos ? message : "";
  }));
  fs::permissions(base_, fs::perms::owner_all);
}

/// Records until it fails, as a run would, and reports in which way it did not fail as it should.
std::string record_until_full(const fs::path& file, const std::string& reason) {
  const Recording run = random_run(4096);
  const auto record = [&] {
    SessionWriter writer(file, run.info);
    for (int round = 0; round < 4; ++round) {
      for (std::size_t i = 0; i < run.frames.size(); ++i) {
        writer.append(run.frames[i], run.samples[i], run.outputs[i]);
      }
    }
    writer.finish();
  };
  const std::string message = message_of<RunError>(record);
  const bool good = message.starts_with(file.string()) &&
                    message.find(reason) != std::string::npos &&
                    message.find('\n') == std::string::npos;
  return good ? "" : "message: " + message;
}

TEST_F(SessionTest, AFileSizeLimitIsARunError) {
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    std::signal(SIGXFSZ, SIG_IGN);
    for (const rlim_t limit : {0U, 4096U, 100000U, 1000000U}) {
      const rlimit size{limit, RLIM_INFINITY};
      if (setrlimit(RLIMIT_FSIZE, &size) != 0) return "cannot set the limit";
      fs::remove(file_);
      if (std::string wrong = record_until_full(file_, "File too large"); !wrong.empty()) {
        return wrong;
      }
    }
    return "";
  }));
}

// The library would write again what it could not write, when the program is long past its last
// line.
TEST_F(SessionTest, AProgramEndsOrderlyAfterAWriteError) {
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit size{100000, RLIM_INFINITY};
    if (setrlimit(RLIMIT_FSIZE, &size) != 0) return "cannot set the limit";
    if (std::string wrong = record_until_full(file_, "File too large"); !wrong.empty()) {
      return wrong;
    }
    std::exit(0);
  }));
}

TEST_F(SessionTest, AFullDiskIsARunError) {
  const bool possible = succeeds_in_child([&]() -> std::string {
    // A small disk that only this child sees.
    if (unshare(CLONE_NEWNS) != 0 ||
        mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        mount("tmpfs", base_.c_str(), "tmpfs", 0, "size=1m") != 0) {
      return kNotPossibleHere;
    }
    if (std::string wrong = record_until_full(file_, "No space left on device"); !wrong.empty()) {
      return wrong;
    }
    // The same for a disk that is full before the run begins.
    write_text(base_ / "rest", std::string(std::size_t{2} << 20, 'x'));
    return record_until_full(base_ / "second.h5", "No space left on device");
  });
  if (!possible) GTEST_SKIP() << "may not mount a small disk; AFileSizeLimitIsARunError has to do";
}

TEST_F(SessionTest, AKilledRunKeepsItsBlocks) {
  Recording run = random_run(2 * SessionWriter::kBlockRows + 300);
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    SessionWriter writer(file_, run.info);
    writer.write_terrain_before(run.before.view());
    for (std::size_t i = 0; i < run.frames.size(); ++i) {
      writer.append(run.frames[i], run.samples[i], run.outputs[i]);
    }
    _exit(0);
  }));
  const SessionReader reader(file_);
  EXPECT_FALSE(reader.complete());
  EXPECT_TRUE(reader.content_hash().empty());
  ASSERT_EQ(reader.frames(), 2 * SessionWriter::kBlockRows);
  EXPECT_TRUE(reader.terrain_before());
  EXPECT_FALSE(reader.terrain_after());
  run.samples.resize(2048);
  run.outputs.resize(2048);
  expect_rows<kSampleBytes>(reader, run.samples);
  expect_rows<kOutputBytes>(reader, run.outputs);
}

TEST_F(SessionTest, AnUnfinishedFileHasTheTicksThatAllTablesHave) {
  for (const char* table : {"frames", "samples", "outputs"}) {
    fs::remove(file_);
    write_run(file_, random_run(5));
    edit([&](hid_t file) {
      H5Adelete(file, "content_hash");
      const h5::Handle dataset(H5Dopen2(file, table, H5P_DEFAULT), H5Dclose, table);
      const hsize_t rows = 3;
      h5::check(H5Dset_extent(dataset.get(), &rows), table);
    });
    EXPECT_EQ(SessionReader(file_).frames(), 3U) << table;
  }
}

TEST_F(SessionTest, AnAbandonedWriterLeavesAnUnfinishedFile) {
  { const SessionWriter writer(file_, random_run(0).info); }
  EXPECT_FALSE(SessionReader(file_).complete());
}

}  // namespace
}  // namespace screed
