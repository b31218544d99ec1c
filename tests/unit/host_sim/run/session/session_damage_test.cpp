// Sessions that are damaged, or that cannot be written.
#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <unistd.h>
#include <algorithm>
#include <cmath>
#include <csignal>

#include "tests/child_process.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {

namespace {

// Files that are no session, or a damaged, older or newer one: one line says so.

TEST_F(SessionTest, FilesThatAreNoSessionAreRefused) {
  expect_refused("no such file");
  fs::create_directory(file_);
  expect_refused("is a folder");
  fs::remove(file_);
  write_text(file_, "");
  expect_refused("not an HDF5 file");
  write_text(file_, "time [s],x [m]\n0,0\n");
  expect_refused("not an HDF5 file");
  fs::remove(file_);
  {
    const h5::Handle foreign(H5Fcreate(file_.c_str(), H5F_ACC_EXCL, H5P_DEFAULT, H5P_DEFAULT),
                             H5Fclose, "create");
  }
  expect_refused("another program");
}

TEST_F(SessionTest, ATruncatedFileIsRefused) {
  write_run(file_, random_run(1200));
  const std::string whole = read_text(file_);
  ::testing::internal::CaptureStderr();
  for (std::size_t size = whole.size() - 1; size > 2000; size -= size / 9) {
    write_text(file_, whole.substr(0, size));
    expect_refused("truncated");
  }
  write_text(file_, whole.substr(0, 4));
  expect_refused("not an HDF5 file");
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");  // the library has no say
}

TEST_F(SessionTest, DamagedRowsAreReported) {
  write_run(file_, random_run(1200));
  std::string bytes = read_text(file_);
  // The frames of a block are most of the file; somewhere in the middle is one of theirs.
  for (std::size_t i = 0; i < 64; ++i) bytes[bytes.size() / 2 + i] = static_cast<char>(0x5A);
  write_text(file_, bytes);
  const std::string message =
      message_of<InputError>([&] { SessionReader(file_).compute_content_hash(); });
  expect_line(message, file_, "damaged");
}

TEST_F(SessionTest, ANewerFormatIsRefused) {
  write_run(file_, random_run(1));
  edit([](hid_t file) { h5::write_attribute(file, "format_version", std::uint64_t{2}); });
  expect_refused("format 2 is not known; this program reads up to format 1");
}

TEST_F(SessionTest, AMissingOrWrongPartIsNamed) {
  const auto broken = [&](const std::function<void(hid_t)>& change, const std::string& part) {
    fs::remove(file_);
    write_run(file_, random_run(5));
    edit(change);
    expect_refused(part);
  };
  broken([](hid_t f) { H5Adelete(f, "seed"); }, "'seed' is missing");
  broken(
      [](hid_t f) {
        H5Adelete(f, "seed");
        h5::write_attribute(f, "seed", std::string("7"));
      },
      "'seed' is not an integer");
  broken([](hid_t f) { H5Ldelete(f, "samples", H5P_DEFAULT); }, "'samples' is missing");
  broken([](hid_t f) { H5Ldelete(f, "parameters", H5P_DEFAULT); }, "'parameters'");
  broken([](hid_t f) { h5::write_attribute(f, "frames", std::uint64_t{6}); }, "6 rows");
  broken(
      [](hid_t f) {
        const h5::Handle group(H5Gopen2(f, "parameters", H5P_DEFAULT), H5Gclose, "parameters");
        h5::write_attribute(group.get(), "climb_speed", std::int64_t{40000});
      },
      "'climb_speed' is 40000");
}

/// Replaces a table by one with the columns that `keep` accepts; integers are of 64 bits, which
/// must not matter.
void rewrite_table(hid_t file, const char* name, std::size_t rows, std::span<const Column> columns,
                   const std::function<bool(const Column&)>& keep) {
  constexpr std::size_t kWidest = std::size_t{8} * kRadioInCapacity;  // bytes of a column
  H5Ldelete(file, name, H5P_DEFAULT);
  std::vector<const Column*> kept;
  for (const Column& column : columns) {
    if (keep(column)) kept.push_back(&column);
  }
  const h5::Handle type(H5Tcreate(H5T_COMPOUND, kWidest * kept.size()), H5Tclose, "type");
  std::size_t offset = 0;
  for (const Column* column : kept) {
    const hid_t element = column->type == ColumnType::kDouble ? H5T_IEEE_F64LE : H5T_STD_I64LE;
    const hsize_t count = column->count;
    const h5::Handle array(H5Tarray_create2(element, 1, &count), H5Tclose, "array");
    h5::check(H5Tinsert(type.get(), column->name, offset, column->array ? array.get() : element),
              "insert");
    offset += std::size_t{8} * column->count;
  }
  const hsize_t size = rows;
  const h5::Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose, "space");
  const h5::Handle dataset(
      H5Dcreate2(file, name, type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, name);
  std::vector<std::uint64_t> values(kWidest / 8 * kept.size() * rows, 5);
  h5::check(H5Dwrite(dataset.get(), type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
            "write");
}

TEST_F(SessionTest, OldFilesWithFewerFrameColumnsAreRead) {
  write_run(file_, random_run(3));
  edit([](hid_t file) {
    rewrite_table(file, "frames", 3, kFrameColumns, [](const Column& column) {
      const std::string name = column.name;
      return name != "battery" && name != "faults";
    });
    const h5::Handle group(H5Gopen2(file, "parameters", H5P_DEFAULT), H5Gclose, "parameters");
    H5Adelete(group.get(), "climb_speed");
  });
  const SessionReader reader(file_);
  EXPECT_EQ(reader.missing_columns(), (std::vector<std::string>{"battery", "faults"}));
  EXPECT_EQ(reader.missing_parameters(), (std::vector<std::string>{"climb_speed"}));
  EXPECT_EQ(reader.info().parameters.climb_speed(), Parameters{}.climb_speed());
  std::vector<SimFrame> frames(3);
  reader.read(0, std::span(frames));
  for (const SimFrame& frame : frames) {
    EXPECT_TRUE(std::isnan(frame.battery));
    EXPECT_EQ(frame.faults, 0);
    EXPECT_EQ(frame.state, 5);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(frame.time), 5U);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(frame.energy), 5U);
  }
}

TEST_F(SessionTest, SamplesNeedAllTheirColumns) {
  write_run(file_, random_run(3));
  edit([](hid_t file) {
    rewrite_table(file, "samples", 3, kSampleColumns,
                  [](const Column& column) { return std::string(column.name) != "pressure"; });
  });
  expect_refused("table 'samples': column 'pressure' is missing");
}

TEST_F(SessionTest, TooManyRadioBytesAreRefused) {
  Recording run = random_run(2);
  run.outputs[1].radio_out_count = kRadioOutCapacity + 1;
  write_run(file_, run);
  std::vector<RobotOutput> outputs(2);
  const SessionReader reader(file_);
  expect_line(message_of<InputError>([&] { reader.read(0, std::span(outputs)); }), file_,
              "row 1: 89 radio bytes");
}

// What goes wrong while a session is being written: full disks, killed programs.

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
