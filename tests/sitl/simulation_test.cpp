// A whole run with its folder: reproducible, replayable, stoppable.
#include "host_sim/run/simulation/simulation.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <span>
#include <sstream>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/record.h"
#include "host_sim/run/session/replay.h"
#include "host_sim/run/session/session_reader.h"
#include "paths.h"
#include "tests/sitl/test_drive.h"
#include "tests/temp_folder.h"

namespace screed::testing {
namespace {

class Simulation : public ::testing::Test {
 protected:
  void SetUp() override {
    experiment_ =
        read_experiment(std::filesystem::path(kDataFolder) / "experiments" / "first_drive.ini",
                        {"experiment.duration=8", "parameters.climb_threshold=300"});
  }

  SimulationSummary run(const std::string& name, bool pictures = false) {
    SimulationOptions options;
    options.pictures = pictures;
    options.out = root_ / name;
    return run_simulation(experiment_, options);
  }
  static std::string content(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }

  TempFolder temporary_;
  std::filesystem::path root_ = temporary_.path();
  Experiment experiment_;
};

TEST_F(Simulation, SameSeedSameBytesOtherSeedOtherBytes) {
  const SimulationSummary first = run("first", true);
  const SimulationSummary second = run("second", true);
  EXPECT_EQ(first.content_hash, second.content_hash);
  EXPECT_EQ(content(root_ / "first" / "frames.csv"), content(root_ / "second" / "frames.csv"));
  EXPECT_EQ(content(root_ / "first" / "telemetry.log"),
            content(root_ / "second" / "telemetry.log"));
  EXPECT_EQ(content(root_ / "first" / "terrain_after.png"),
            content(root_ / "second" / "terrain_after.png"));
  EXPECT_EQ(content(root_ / "first" / "summary.json"), content(root_ / "second" / "summary.json"));
  experiment_.experiment.seed = 2;
  EXPECT_NE(run("third").content_hash, first.content_hash);
}

TEST_F(Simulation, LeavesARunFolderThatReplays) {
  const SimulationSummary summary = run("run", true);
  for (const char* file : {"session.h5", "frames.csv", "telemetry.log", "terrain_before.png",
                           "terrain_after.png", "experiment.ini", "summary.json"}) {
    EXPECT_GT(std::filesystem::file_size(root_ / "run" / file), 0u) << file;
  }
  EXPECT_FALSE(std::filesystem::exists(root_ / "run.partial"));
  const SessionReader session(root_ / "run" / "session.h5");
  EXPECT_EQ(session.frames(), 800u);
  EXPECT_EQ(session.content_hash(), summary.content_hash);
  const ReplayResult replay = replay_session(root_ / "run" / "session.h5");
  EXPECT_EQ(replay.ticks, 800u);
  EXPECT_FALSE(replay.first_difference_tick.has_value()) << replay.first_difference;
}

TEST_F(Simulation, WhatIfPartsFromTheRecordingWhereTheWholeRunDoes) {
  run("recorded");
  experiment_.parameters.walk_speed_max() = 100;
  run("other");
  const SessionReader recorded(root_ / "recorded" / "session.h5");
  const SessionReader other(root_ / "other" / "session.h5");
  std::vector<RobotOutput> a(recorded.frames());
  std::vector<RobotOutput> b(other.frames());
  recorded.read(0, std::span(a));
  other.read(0, std::span(b));
  const auto parted =
      std::mismatch(a.begin(), a.end(), b.begin(), [](const auto& x, const auto& y) {
        std::array<std::uint8_t, kOutputBytes> row_x{};
        std::array<std::uint8_t, kOutputBytes> row_y{};
        pack(x, OutputRow(row_x));
        pack(y, OutputRow(row_y));
        return row_x == row_y;
      });
  ASSERT_NE(parted.first, a.end());
  ReplayOptions what_if;
  what_if.parameters = experiment_.parameters;
  const ReplayResult replay = replay_session(root_ / "recorded" / "session.h5", what_if);
  EXPECT_EQ(replay.first_difference_tick, static_cast<std::uint64_t>(parted.first - a.begin()));
}

TEST_F(Simulation, TheRecordedExperimentGivesTheSameRunAgain) {
  const SimulationSummary first = run("first");
  experiment_ = read_experiment(root_ / "first" / "experiment.ini");
  EXPECT_EQ(run("again").content_hash, first.content_hash);
}

TEST_F(Simulation, AStoppedRunKeepsWhatItHas) {
  std::atomic<bool> stop = false;
  SimulationOptions options;
  options.out = root_ / "run";
  options.stop = &stop;
  options.progress = [&](const SimulationProgress& progress) {
    if (progress.time_s >= 3.0) stop = true;
  };
  const SimulationSummary summary = run_simulation(experiment_, options);
  EXPECT_TRUE(summary.stopped_early());
  EXPECT_NEAR(summary.time_s, 3.0, 0.011);
  EXPECT_EQ(SessionReader(root_ / "run" / "session.h5").frames(), 300u);
  EXPECT_TRUE(std::filesystem::exists(root_ / "run" / "terrain_after.png"));
}

TEST_F(Simulation, WrongInputLeavesNothing) {
  experiment_.map.filename = "no_such_image.png";
  EXPECT_THROW(run("run"), InputError);
  EXPECT_TRUE(std::filesystem::is_empty(root_));
}

TEST_F(Simulation, TheWheeledRobotRunsToo) {
  experiment_.vehicle.tracks = false;
  EXPECT_GT(run("run").distance_m, 0.1);
}

}  // namespace
}  // namespace screed::testing
