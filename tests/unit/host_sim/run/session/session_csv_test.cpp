// The frames of a session as CSV.
#include <sys/resource.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <sstream>

#include "host_sim/run/session/export.h"
#include "tests/child_process.h"
#include "tests/unit/host_sim/run/session/session_fixture.h"

namespace screed {
namespace {

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

}  // namespace
}  // namespace screed
