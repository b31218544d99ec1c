// Firmware and sensors of a rollout: those of the recorded robot, tick by tick and bit by bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/session/export.h"
#include "host_sim/run/simulation/recorders.h"
#include "host_sim/run/world/frame_recorder.h"
#include "host_sim/run/world/world_setup.h"
#include "nn/surrogate/rollout.h"
#include "nn/surrogate/surrogate_plant.h"
#include "tests/step_one.h"
#include "tests/unit/host_sim/run/rover5_plant.h"
#include "tests/unit/nn/surrogate/linear_model.h"
#include "tests/unit/nn/surrogate/made_up_drive.h"

namespace screed::nn {
namespace {

/// A session in which a surrogate stands in for the physics, what a rollout of the same surrogate
/// has to follow; as `screed sim` records it: Algorithm 5 on a level bed whose edges nothing stops
/// at, five seconds until it begins included. `more` are further lines of the experiment.
void record_surrogate(const fs::path& folder, const Surrogate& driven, std::size_t rows,
                      const std::string& more = "", const std::string& board = kDefaultBoard) {
  fs::create_directories(folder);
  write_text(folder / "experiment.ini",
             "[map]\nmodel = scm\nsize = 2\nedges = open\n[soil]\npreset = soft\ncell = 0.02\n"
             "[experiment]\nname = made_up\nalgorithm = training_drive\nframes = 3200\n" +
                 more);
  const Experiment experiment = read_experiment(folder / "experiment.ini");
  const auto environment = [&](HeightField terrain, const Assembly& model,
                               const PlantOptions& options) {
    return std::make_unique<SurrogatePlant>(std::move(terrain), model, options, driven);
  };
  const auto world = make_world(experiment, {.board = board, .environment = environment});
  SessionInfo info;
  info.experiment_name = experiment.experiment.name;
  info.experiment_text = experiment.text();
  info.seed = experiment.experiment.seed;
  info.board_name = board;
  info.board = board_constants_of(board);
  info.parameters = experiment.parameters;
  info.credentials = credentials_of(experiment);
  SessionWriter writer(folder / "session.h5", info);
  writer.record_heights(map_of(world->terrain()).view());
  HeightWatch watch(world->terrain());
  FrameRecorder frames;
  for (std::size_t row = 0; row < rows; ++row) {
    world->advance();
    const SimFrame frame =
        frames.record(world->plant().time_s(), world->plant().robot(0), world->firmware());
    writer.append(frame, world->sample(), world->output(), watch.changes(world->terrain()));
  }
  writer.finish();
}

const Surrogate& skidding_robot() {
  static const Surrogate robot(skid_of(0.96), SupportGeometry{}, 1);
  return robot;
}

/// A session that a surrogate drove, read.
struct Session {
  explicit Session(const std::string& more = "", const std::string& board = kDefaultBoard) {
    const TempFolder folder;
    record_surrogate(folder.path() / "run", skidding_robot(), 720, more, board);
    const SessionReader reader(folder.path() / "run" / "session.h5");
    info = reader.info();
    experiment = read_experiment(folder.path() / "run" / "experiment.ini");
    samples.resize(reader.frames());
    outputs.resize(reader.frames());
    reader.read(0, std::span(samples));
    reader.read(0, std::span(outputs));
  }
  SurrogatePlant plant() const {
    PlantOptions options;
    options.soil = make_soil(experiment);
    options.vehicle.motor = board_motor(info.board_name).motor;
    options.battery = make_battery(experiment, info.board_name);
    return {HeightField(16, 16, 0.25, true), make_robot_model(experiment, info.board_name), options,
            skidding_robot()};
  }
  SessionInfo info;
  Experiment experiment;
  std::vector<SensorSample> samples;
  std::vector<RobotOutput> outputs;
};

std::array<double, 2> duty_ratio_of(const RobotOutput& output) {
  return {output.duty_left / static_cast<double>(kDutyMax),
          output.duty_right / static_cast<double>(kDutyMax)};
}

/// The robot drives the plant from the first row on and gets of the recording time and radio alone.
/// Its sensors must say, and its firmware must answer, what was recorded.
void expect_same_drive(const Session& session) {
  SurrogatePlant plant = session.plant();
  RolloutRobot robot(session.info, session.experiment);
  std::size_t driving = 0;
  for (std::size_t row = 0; row < session.samples.size(); ++row) {
    for (int i = 0; i < plant.steps_per_tick(); ++i) testing::step_one(plant, robot.duty_ratio());
    SensorSample given = session.samples[row];
    for (int axis = 0; axis < 3; ++axis) given.imu.gyro()[axis] = given.imu.accel()[axis] = 0;
    given.encoder_left = given.encoder_right = given.battery = 0;
    RolloutRobot measuring = robot;
    ASSERT_EQ(packed<kSampleBytes>(measuring.measure(plant, given)),
              packed<kSampleBytes>(session.samples[row]))
        << "row " << row;
    robot.tick(plant, given);
    ASSERT_EQ(robot.duty_ratio(), duty_ratio_of(session.outputs[row])) << "row " << row;
    if (session.outputs[row].duty_left != 0) ++driving;
  }
  EXPECT_GT(driving, 100U);
}

TEST(RolloutRobot, DrivesAPlantAsTheRecordedRobotDid) {
  expect_same_drive(Session());
}

TEST(RolloutRobot, HasTheSensorsOfARobotWithoutNoise) {
  expect_same_drive(Session("[sensors]\nnoise = false\n"));
}

TEST(RolloutRobot, HasTheSensorsOfARobotThatIsNotCalibrated) {
  expect_same_drive(Session("[sensors]\ncalibrated = false\n"));
}

TEST(RolloutRobot, HasTheSeedOfTheExperimentAndTheMotorsOfTheBoard) {
  expect_same_drive(Session("seed = 77\n[parameters]\nbattery_low = 4000\n", "zumo_32u4"));
}

TEST(RolloutRobot, FollowsARecordingAndThenGoesOnByItself) {
  const Session session;
  SurrogatePlant plant = session.plant();
  RolloutRobot follower(session.info, session.experiment);
  RolloutRobot driver(session.info, session.experiment);
  const std::size_t last = session.samples.size() - 50;
  for (std::size_t row = 0; row < session.samples.size(); ++row) {
    for (int i = 0; i < plant.steps_per_tick(); ++i) testing::step_one(plant, driver.duty_ratio());
    driver.tick(plant, session.samples[row]);
    if (row < last) {
      follower.follow(session.samples[row]);
    } else {
      follower.tick(plant, session.samples[row]);  // with the noise of this row
    }
    ASSERT_EQ(follower.duty_ratio(), duty_ratio_of(session.outputs[row])) << "row " << row;
  }
}

// ---- encoders and battery ----------------------------------------------------------------------

SensorSample measured(const DrivingState& state, std::uint16_t battery_uv_per_lsb = 1831) {
  SessionInfo info = random_run(0).info;
  info.board.battery_uv_per_lsb = battery_uv_per_lsb;
  SurrogatePlant plant(HeightField(16, 16, 0.25, true), rover5(), on_soil(PlantOptions{}),
                       skidding_robot());
  plant.set_state(state);
  RolloutRobot robot(info, Experiment{});
  EXPECT_EQ(robot.counts_per_turn(), board_motor(info.board_name).counts_per_turn);
  return robot.measure(plant, SensorSample{});
}

TEST(RolloutRobot, EncodersShowTheWholeCountsBelowTheAngleModulo65536) {
  const double count = 2.0 * std::numbers::pi / board_motor("a_star_32u4").counts_per_turn;
  DrivingState state;
  state.shaft_angle_rad = {70001.9 * count, -0.5 * count};
  SensorSample sample = measured(state);
  EXPECT_EQ(sample.encoder_left, 70001 - 65536);
  EXPECT_EQ(sample.encoder_right, 65535);
  state.shaft_angle_rad = {-1.5 * count, 65535.5 * count};
  sample = measured(state);
  EXPECT_EQ(sample.encoder_left, 65534);
  EXPECT_EQ(sample.encoder_right, 65535);
}

TEST(RolloutRobot, TheBatteryIsMeasuredToTheNearestStepUpToItsLimit) {
  DrivingState state;
  state.battery.terminal_v = 7.5;
  EXPECT_EQ(measured(state, 2000).battery, 3750);
  EXPECT_EQ(measured(state, 999).battery, 7508) << "7507.5 and a little more";
  EXPECT_EQ(measured(state, 700).battery, 8 * 1023) << "no more";
  state.battery.terminal_v = 0.0;
  EXPECT_EQ(measured(state, 2000).battery, 0);
}

// ---- Rollouts that the firmware drives, beside sessions of the same surrogate: it has to follow
// itself

constexpr std::size_t kRows = 3000;

SurrogateFactory skidding(double speed_share = 0.96) {
  return {"skid", [=] { return Surrogate(skid_of(speed_share), SupportGeometry{}, 1); }};
}

RolloutOptions one_start() {
  RolloutOptions options;
  options.starts = 1;
  return options;
}

/// The greatest distance between a rollout's path and the recorded one.
double farthest(const SessionRollouts& result, std::size_t surrogate = 0,
                std::size_t strides = std::numeric_limits<std::size_t>::max()) {
  const std::vector<PlanarPose>& path = result.by_surrogate[surrogate].at(0).path;
  const std::vector<PlanarPose>& real = result.real.at(0);
  EXPECT_EQ(path.size(), real.size());
  EXPECT_GT(path.size(), 100U);
  double worst = 0.0;
  for (std::size_t i = 0; i < std::min({path.size(), real.size(), strides}); ++i) {
    worst = std::max(worst, std::hypot(path[i].x_m - real[i].x_m, path[i].y_m - real[i].y_m));
  }
  return worst;
}

void expect_to_follow_itself(const std::string& board, const std::string& more = "") {
  const TempFolder folder;
  record_surrogate(folder.path() / "run", skidding().robot(), kRows, more, board);
  const SessionRollouts result =
      roll_out(folder.path() / "run", {skidding(), skidding(0.8)}, one_start());
  EXPECT_EQ(result.source, "made_up");
  const RolloutCheck& same = result.by_surrogate[0].at(0).checks[0];
  EXPECT_TRUE(same.reached);
  EXPECT_LT(same.position_error, 5e-4);
  EXPECT_LT(same.heading_error_rad, 2e-3);
  EXPECT_LT(farthest(result), 2e-3);  // the last bits of the field turn the heading
  // Encoders do not notice that the robot slips.
  EXPECT_GT(farthest(result, 1), 0.05);
}

TEST(RolloutFirmware, FollowsASessionOfTheSameSurrogateAndNotOfAnother) {
  expect_to_follow_itself("a_star_32u4");
}

TEST(RolloutFirmware, FollowsASessionWithTheMotorsOfAnotherBoard) {
  // Half full: there the voltage hardly depends on the charge, which a recording says to a few
  // parts in a million; the converter's last digit depends on those where the curve is steep.
  expect_to_follow_itself("zumo_32u4",
                          "[battery]\ncharge = 0.5\n[parameters]\nbattery_low = 4000\n");
}

/// The session with rows changed.
void alter(const fs::path& from, const fs::path& to,
           const std::function<void(std::size_t row, SensorSample&)>& change) {
  const SessionReader session(from / "session.h5");
  std::vector<SimFrame> frames(session.frames());
  std::vector<SensorSample> samples(session.frames());
  session.read(0, std::span(frames));
  session.read(0, std::span(samples));
  fs::create_directories(to);
  fs::copy_file(from / "experiment.ini", to / "experiment.ini");
  SessionWriter writer(to / "session.h5", session.info());
  writer.record_heights(session.heights_after(0).view());
  for (std::size_t row = 0; row < frames.size(); ++row) {
    change(row, samples[row]);
    writer.append(frames[row], samples[row], RobotOutput{});
  }
  writer.finish();
}

TEST(RolloutFirmware, EndsWithTheLastFrameItMayHave) {
  const TempFolder folder;
  record_surrogate(folder.path() / "run", skidding().robot(), kRows);
  RolloutOptions options = one_start();
  for (const std::size_t frames : {2200U, 2199U}) {
    options.max_frames = frames;
    const SessionRollouts result = roll_out(folder.path() / "run", {skidding()}, options);
    EXPECT_EQ(result.by_surrogate[0].at(0).path.size(), frames / 10);
    EXPECT_EQ(result.real.at(0).size(), frames / 10);
  }
}

TEST(RolloutFirmware, MeasuresByItselfFromTheStartOn) {
  const TempFolder folder;
  const fs::path run = folder.path() / "run";
  const fs::path altered = folder.path() / "altered";
  record_surrogate(run, skidding().robot(), kRows);
  const Rollout rollout = roll_out(run, {skidding()}, one_start()).by_surrogate[0].at(0);
  const auto expect_same_path = [&](bool same) {
    const Rollout other = roll_out(altered, {skidding()}, one_start()).by_surrogate[0].at(0);
    ASSERT_EQ(other.path.size(), rollout.path.size());
    bool equal = true;
    for (std::size_t i = 0; i < rollout.path.size(); ++i) {
      equal = equal && other.path[i].x_m == rollout.path[i].x_m &&
              other.path[i].heading_rad == rollout.path[i].heading_rad;
    }
    EXPECT_EQ(equal, same);
    fs::remove_all(altered);
  };
  const auto wipe = [](SensorSample& sample) {
    for (int axis = 0; axis < 3; ++axis) sample.imu.gyro()[axis] = sample.imu.accel()[axis] = 0;
    sample.encoder_left = sample.encoder_right = sample.battery = 0;
  };
  alter(run, altered, [&](std::size_t row, SensorSample& sample) {
    if (row > rollout.start) wipe(sample);
  });
  expect_same_path(true);
  // The firmware has received all samples up to the start.
  alter(run, altered, [&](std::size_t row, SensorSample& sample) {
    if (row >= rollout.start) wipe(sample);
  });
  expect_same_path(false);
}

}  // namespace
}  // namespace screed::nn
