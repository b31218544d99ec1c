// A session's frames as CSV, and its content hash.
#include <sys/resource.h>
#include <bit>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <sstream>

#include "firmware/parameters/parameters.h"
#include "host_sim/run/session/export.h"
#include "tests/child_process.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {

namespace {

// The frames of a session as CSV.

TEST_F(SessionTest, CsvHasAllNumbersExactly) {
  const Recording run = random_run(1300);
  write_run(file_, run);
  export_frames_csv(SessionReader(file_), base_ / "frames.csv");
  std::ifstream csv(base_ / "frames.csv");
  std::string line;
  ASSERT_TRUE(std::getline(csv, line));
  EXPECT_EQ(line.substr(0, 24), "time [s],x [m],y [m],z [");
  EXPECT_NE(line.find(",pitch [rad],"), std::string::npos);
  EXPECT_NE(line.find(",slip_left [1],"), std::string::npos);
  EXPECT_TRUE(line.ends_with(",faults,beds_x,beds_y")) << line;
  for (const SimFrame& frame : run.frames) {
    ASSERT_TRUE(std::getline(csv, line));
    SimFrame read;
    const char* cursor = line.c_str();
    char* end = nullptr;
#define SCREED_READ(type, name, unit, meaning)                                               \
  read.name = static_cast<type>(std::strtod(cursor, &end));                                  \
  if (std::isnan(frame.name)) read.name = frame.name; /* NaNs lose their payload, no more */ \
  cursor = end + 1;
    SCREED_FRAME_COLUMNS(SCREED_READ)
#undef SCREED_READ
    EXPECT_EQ(cursor, line.c_str() + line.size() + 1);
    ASSERT_EQ(packed<kFrameBytes>(read), packed<kFrameBytes>(frame)) << line;
  }
  EXPECT_FALSE(std::getline(csv, line));
}

TEST_F(SessionTest, CsvWritesTheShortestNumbers) {
  Recording run = random_run(1);
  run.frames[0].time = 0.1;
  run.frames[0].x = -2;
  run.frames[0].y = 1e-9;
  write_run(file_, run);
  export_frames_csv(SessionReader(file_), base_ / "frames.csv");
  EXPECT_NE(read_text(base_ / "frames.csv").find("\n0.1,-2,1e-09,"), std::string::npos);
}

TEST_F(SessionTest, CsvOfTheLevelingCurve) {
  LevelingPoint point;
  point.time = 30.0;
  point.relief = 0.0125;
  point.off_site = 0.25;
  export_leveling_csv(std::vector{point, LevelingPoint()}, base_ / "leveling.csv");
  std::istringstream csv(read_text(base_ / "leveling.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_TRUE(line.starts_with("time [s],level_deviation [m],relief [m],roughness [m],")) << line;
  EXPECT_NE(line.find(",transport [m3 m],"), std::string::npos) << line;
  std::getline(csv, line);
  EXPECT_TRUE(line.starts_with("30,nan,0.0125,nan,")) << line;
  EXPECT_TRUE(line.ends_with(",nan,0.25,nan,nan")) << line;
  std::getline(csv, line);
  EXPECT_TRUE(line.starts_with("nan,nan,")) << line;
  EXPECT_FALSE(std::getline(csv, line));
}

TEST_F(SessionTest, CsvThatCannotBeWrittenIsARunErrorAndLeavesNothing) {
  write_run(file_, random_run(1300));
  const SessionReader reader(file_);
  const fs::path nowhere = base_ / "missing" / "frames.csv";
  expect_line(message_of<RunError>([&] { export_frames_csv(reader, nowhere); }), nowhere,
              "No such file or directory");
  write_text(base_ / "frames.csv", "precious");
  EXPECT_TRUE(succeeds_in_child([&]() -> std::string {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit size{50000, RLIM_INFINITY};
    if (setrlimit(RLIMIT_FSIZE, &size) != 0) return "cannot set the limit";
    const std::string message =
        message_of<RunError>([&] { export_frames_csv(reader, base_ / "frames.csv"); });
    return message.find("File too large") == std::string::npos ? message : "";
  }));
  EXPECT_EQ(read_text(base_ / "frames.csv"), "precious");
  EXPECT_EQ(std::distance(fs::directory_iterator(base_), {}), 2);  // and nothing half-written
}

// The content hash of a session: what it covers, and what it does not.

TEST_F(SessionTest, TheHashCoversEveryByteOfEveryRow) {
  Recording run = random_run(1);
  run.samples[0].radio_in_count = kRadioInCapacity - 1;
  run.outputs[0].radio_out_count = kRadioOutCapacity - 1;
  int number = 0;
  const auto hash = [&](const Recording& changed) {
    return write_run(base_ / (std::to_string(number++) + ".h5"), changed);
  };
  const std::string original = hash(run);
  EXPECT_EQ(hash(run), original);
  const auto check = [&]<std::size_t N, class Row>(const std::array<std::uint8_t, N>& bytes,
                                                   Row& row, std::span<const Column> columns) {
    const Row unchanged = row;
    for (std::size_t i = 0; i < N; ++i) {
      auto other = bytes;
      other[i] ^= 1;
      unpack(other, row);
      const bool valid = columns.back().array ? i + 1 < N : true;  // the last radio byte is not
      EXPECT_EQ(hash(run) != original, valid) << columns.front().name << "..., byte " << i;
    }
    row = unchanged;
  };
  check(packed<kFrameBytes>(run.frames[0]), run.frames[0], kFrameColumns);
  check(packed<kSampleBytes>(run.samples[0]), run.samples[0], kSampleColumns);
  check(packed<kOutputBytes>(run.outputs[0]), run.outputs[0], kOutputColumns);
  EXPECT_EQ(hash(run), original);
}

TEST_F(SessionTest, TheHashCoversTheConditionsButNotTheNames) {
  const Recording run = random_run(2);
  int number = 0;
  const auto hash = [&](const std::function<void(Recording&)>& change) {
    Recording changed = run;
    change(changed);
    return write_run(base_ / (std::to_string(number++) + ".h5"), changed);
  };
  const std::string original = hash([](Recording&) {});
  EXPECT_EQ(original, hash([](Recording& r) { r.info.program_version = "9"; }));
  EXPECT_EQ(original, hash([](Recording& r) { r.info.experiment_name = "pit"; }));
  EXPECT_EQ(original, hash([](Recording& r) { r.info.board_name = "other"; }));

  EXPECT_NE(original, hash([](Recording& r) { ++r.info.seed; }));
  EXPECT_NE(original, hash([](Recording& r) { r.info.experiment_text += ' '; }));
  EXPECT_NE(original, hash([](Recording& r) { r.info.tick_rate_hz = 50; }));
  EXPECT_NE(original, hash([](Recording& r) { ++r.info.board.tread_mm; }));
  for (const ParameterInfo& parameter : kParameterTable) {
    EXPECT_NE(original, hash([&](Recording& r) { ++r.info.parameters.values[parameter.number]; }))
        << parameter.name;
  }
  EXPECT_NE(original, hash([](Recording& r) { ++r.before.heights[5]; }));
  EXPECT_NE(original, hash([](Recording& r) { ++r.after.heights[5]; }));
  EXPECT_NE(original, hash([](Recording& r) { std::swap(r.before, r.after); }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.unit_m = 2e-6; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.spacing_m = 0.025; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.origin_x_m = 0; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.origin_y_m = 0; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.wrap = false; }));
  EXPECT_NE(original, hash([](Recording& r) { r.before.geometry.walls = true; }));
  EXPECT_NE(original,
            hash([](Recording& r) { std::swap(r.before.geometry.nx, r.before.geometry.ny); }));
  EXPECT_NE(original, hash([](Recording& r) { std::swap(r.frames[0], r.frames[1]); }));
}

TEST_F(SessionTest, TheHashShowsAnEditedFile) {
  const std::string hash = write_run(file_, random_run(3));
  edit([](hid_t file) {
    const h5::Handle group(H5Gopen2(file, "parameters", H5P_DEFAULT), H5Gclose, "parameters");
    h5::write_attribute(group.get(), "climb_speed", std::int64_t{124});
  });
  const SessionReader reader(file_);
  EXPECT_EQ(reader.content_hash(), hash);
  EXPECT_NE(reader.compute_content_hash(), hash);
}

}  // namespace

}  // namespace screed
