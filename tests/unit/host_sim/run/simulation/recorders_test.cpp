// What is left of a run: session, path, folder, telemetry log.
#include <gtest/gtest.h>

#include <array>

#include "host_sim/core/errors.h"
#include "host_sim/run/session/session_reader.h"
#include "host_sim/run/simulation/recorders.h"
#include "host_sim/run/simulation/run_files.h"
#include "host_sim/run/world/frame_recorder.h"
#include "tests/temp_folder.h"
#include "tests/unit/test_robot.h"

namespace screed {

namespace {

// From ticks to the session file and the path.

class SessionRecorderTest : public ::testing::Test {
 protected:
  SessionRecorder recorder() const { return {file_, SessionInfo{}, ground_, soil_}; }
  static SimFrame frame(double x, int32_t leveling_state) {
    SimFrame frame;
    frame.x = x;
    frame.y = -x;
    frame.leveling_state = leveling_state;
    return frame;
  }

  TempFolder folder_;
  std::filesystem::path file_ = folder_.path() / "session.h5";
  HeightField ground_ = HeightField::flat(1.0, 0.1);
  std::optional<SoilParameters> soil_;
};

TEST_F(SessionRecorderTest, RecordsFrameSampleAndAnswerOfEachTick) {
  SessionRecorder recorder = this->recorder();
  for (int i = 0; i < 3; ++i) {
    SensorSample sample{};
    sample.time_us = static_cast<uint32_t>(100 + i);
    RobotOutput output{};
    output.duty_left = static_cast<int16_t>(200 + i);
    recorder.observe_terrain(ground_);
    recorder.append(frame(300.0 + i, 0), sample, output);
  }
  const std::string hash = recorder.finish(ground_);
  const SessionReader session(file_);
  EXPECT_EQ(session.content_hash(), hash);
  ASSERT_EQ(session.frames(), 3U);
  std::vector<SimFrame> frames(3);
  std::vector<SensorSample> samples(3);
  std::vector<RobotOutput> outputs(3);
  session.read(0, std::span(frames));
  session.read(0, std::span(samples));
  session.read(0, std::span(outputs));
  EXPECT_EQ(frames[2].x, 302.0);
  EXPECT_EQ(samples[2].time_us, 102U);
  EXPECT_EQ(outputs[2].duty_left, 202);
  EXPECT_EQ(recorder.height_changes(), 0U);
}

TEST_F(SessionRecorderTest, AChangedHeightBelongsToTheTickThatSawIt) {
  SessionRecorder recorder = this->recorder();
  recorder.record_heights(ground_);
  recorder.observe_terrain(ground_);
  recorder.append({}, {}, {});
  ground_.set_node(2, 1, 500);
  recorder.observe_terrain(ground_);
  recorder.append({}, {}, {});
  recorder.observe_terrain(ground_);
  recorder.append({}, {}, {});
  EXPECT_EQ(recorder.height_changes(), 1U);
  recorder.finish(ground_);

  const SessionReader session(file_);
  const size_t node = static_cast<size_t>(ground_.nx()) + 2;
  EXPECT_EQ(session.heights_after(1).heights[node], 0);
  EXPECT_EQ(session.heights_after(2).heights[node], 500);
  EXPECT_EQ(session.heights_after(3).heights[node], 500);
}

TEST_F(SessionRecorderTest, ThePathHasAPointEveryTenthOfASecondFromTheFirstTick) {
  SessionRecorder recorder = this->recorder();
  for (int i = 0; i < 21; ++i) recorder.append(frame(i, i / 10), {}, {});
  ASSERT_EQ(recorder.path().size(), 3U);
  EXPECT_EQ(recorder.path()[1].x_m, 10.0);
  EXPECT_EQ(recorder.path()[1].y_m, -10.0);
  EXPECT_EQ(recorder.path()[1].state, 1U);
  EXPECT_EQ(recorder.path()[2].x_m, 20.0);
}

// The run folder and the telemetry log.

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

// One tick as a session has it.

/// A robot whose truth is what the test says.
class ToldRobot : public RobotView, public VehicleState {
 public:
  ImuTruth motion() const override { return {}; }
  void lay_on_side() override {}
  const VehicleState& vehicle() const override { return *this; }
  const std::array<int64_t, 2>& wrap_counts() const override { return wrap_counts_; }
  Eigen::Vector3d unwrapped_position() const override { return place; }
  const Battery& battery() const override { return battery_; }
  ChassisState chassis() const override { return {}; }
  double track_speed_m_per_s(Side side) const override { return track.at(side); }
  double shaft_angle_rad(Side /*side*/) const override { return 0.0; }
  double current_a(Side /*side*/) const override { return 0.0; }
  double wheel_radius_m(Side /*side*/) const override { return 0.03; }
  double load_n(Side /*side*/) const override { return 0.0; }
  double sinkage_m(Side /*side*/) const override { return 0.0; }
  double ground_speed_m_per_s(Side side) const override { return ground.at(side); }

  std::array<double, 2> track{};
  std::array<double, 2> ground{};
  Eigen::Vector3d place = Eigen::Vector3d::Zero();

 private:
  std::array<int64_t, 2> wrap_counts_{};
  Battery battery_;
};

TEST(FrameRecorderTest, SlipIsThatOfEachTrackDrivenOrBrakedForwardOrBackward) {
  FrameRecorder recorder;
  const TestRobot firmware;
  ToldRobot robot;
  const auto expect_slip = [&](double left, double right) {
    const SimFrame frame = recorder.record(0.0, robot, firmware.robot);
    EXPECT_DOUBLE_EQ(frame.slip_left, left);
    EXPECT_DOUBLE_EQ(frame.slip_right, right);
    EXPECT_EQ(frame.track_left, robot.track[kLeft]);
    EXPECT_EQ(frame.track_right, robot.track[kRight]);
  };
  for (const double way : {1.0, -1.0}) {
    robot.track = {way * 0.2, way * 0.15};
    robot.ground = {way * 0.15, way * 0.2};
    expect_slip(0.25, -0.25);
    // Spinning on the spot, and locked; a track that the other one drags against its own way.
    robot.track = {way * 0.2, 0.0};
    robot.ground = {0.0, way * 0.2};
    expect_slip(1.0, -1.0);
    robot.track = {way * 0.2, way * 0.05};
    robot.ground = {way * 0.2, way * -0.2};
    expect_slip(0.0, 1.0);
  }
}

TEST(FrameRecorderTest, TheWayIsTheSumOfItsStepsFromTheFirstFrameOn) {
  FrameRecorder recorder;
  const TestRobot firmware;
  ToldRobot robot;
  robot.place = {5.0, 0.0, 0.0};
  recorder.record(0.0, robot, firmware.robot);
  EXPECT_EQ(recorder.distance_m(), 0.0);
  robot.place += Eigen::Vector3d(0.03, 0.04, 0.0);
  const SimFrame frame = recorder.record(0.01, robot, firmware.robot);
  EXPECT_NEAR(frame.delta_x, 0.03, 1e-12);
  EXPECT_NEAR(frame.delta_y, 0.04, 1e-12);
  robot.place -= Eigen::Vector3d(0.0, 0.0, 0.05);
  recorder.record(0.02, robot, firmware.robot);
  EXPECT_NEAR(recorder.distance_m(), 0.1, 1e-12);
}

}  // namespace

}  // namespace screed
