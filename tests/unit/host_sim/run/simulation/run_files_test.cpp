// The run folder and the telemetry log.
#include "host_sim/run/simulation/run_files.h"

#include <gtest/gtest.h>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

class RunFilesTest : public ::testing::Test {
 protected:
  RunFilesTest() { options_.out = folder_.path() / "run"; }

  TempFolder folder_;
  SimulationOptions options_;
  Experiment experiment_;
};

TEST_F(RunFilesTest, TheFolderHasItsNameOnceTheRunIsComplete) {
  RunFiles files(experiment_, options_);
  files.write_summary("{}\n");
  EXPECT_FALSE(std::filesystem::exists(*options_.out));
  files.commit();
  EXPECT_EQ(files.final_folder(), *options_.out);
  EXPECT_EQ(read_text(*options_.out / "summary.json"), "{}\n");
  EXPECT_EQ(read_text(*options_.out / "experiment.ini"), experiment_.text());
}

TEST_F(RunFilesTest, ARunThatFailsLeavesNothing) {
  {
    RunFiles files(experiment_, options_);
    write_text(files.session(), "half a session");
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

TEST_F(RunFilesTest, WithoutANameTheFolderIsNumberedInTheRoot) {
  options_.out.reset();
  options_.root = folder_.path();
  experiment_.experiment.name = "hill";
  RunFiles files(experiment_, options_);
  EXPECT_EQ(files.final_folder(), folder_.path() / "hill-0001");
}

TEST_F(RunFilesTest, TheTelemetryLogBeginsWhenItIsOpened) {
  TelemetryLog log;
  log.stream() << "before any file may exist\n";
  log.open(folder_.path() / "telemetry.log");
  log.stream() << "first line\n";
  log.close();
  EXPECT_EQ(read_text(folder_.path() / "telemetry.log"), "first line\n");
}

TEST_F(RunFilesTest, AFullDiskIsReportedWithTheLogsName) {
  TelemetryLog log;
  log.open("/dev/full");
  log.stream() << "a line that does not fit\n";
  try {
    log.close();
    FAIL() << "nothing was said";
  } catch (const RunError& error) {
    EXPECT_STREQ(error.what(), "/dev/full: cannot be written completely; is the disk full?");
  }
  EXPECT_THROW(log.open(folder_.path() / "no" / "folder"), RunError);
}

}  // namespace
}  // namespace screed
