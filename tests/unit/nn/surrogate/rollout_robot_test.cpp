// Firmware and sensors of a rollout: those of the recorded robot, tick by tick and bit by bit.
#include "nn/surrogate/rollout_robot.h"

#include <gtest/gtest.h>

#include <numbers>

#include "host_sim/run/experiment/robot_model.h"
#include "host_sim/run/world/world_setup.h"
#include "tests/step_one.h"
#include "tests/unit/host_sim/run/rover5_plant.h"
#include "tests/unit/nn/surrogate/surrogate_session.h"

namespace screed::nn {
namespace {

const Surrogate& skidding() {
  static const Surrogate robot(skid_of(0.96), SupportGeometry{}, 1);
  return robot;
}

/// A session that a surrogate drove, read.
struct Session {
  explicit Session(const std::string& more = "", const std::string& board = kDefaultBoard) {
    const TempFolder folder;
    record_surrogate(folder.path() / "run", skidding(), 720, more, board);
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
            skidding()};
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
                       skidding());
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

}  // namespace
}  // namespace screed::nn
