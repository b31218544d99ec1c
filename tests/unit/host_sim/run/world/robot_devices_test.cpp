// Radio, encoders and scripted events round a robot.
#include "host_sim/run/world/world.h"

#include <gtest/gtest.h>

#include <memory>
#include <numbers>
#include <sstream>

#include "firmware/protocol/e2e.h"
#include "hal/sample.h"
#include "host_sim/core/errors.h"
#include "tests/step_one.h"
#include "tests/unit/host_sim/run/rover5_plant.h"

namespace screed {
namespace {

Plant plant_at(double x_m) {
  return {HeightField::flat(4.0, 0.1), rover5(), held_at(x_m, 0.0)};
}

/// Roll, degrees; 0 upright.
double roll_deg(const Environment& plant) {
  return attitude_of(plant.robot(0).vehicle().chassis().pose.linear()).roll * 180.0 /
         std::numbers::pi;
}

/// Bytes that reach a robot within a second that started at one x and stands at another.
size_t bytes_received(double start_x_m, double x_m) {
  WorldOptions options;
  options.radio.range_m = 30.0;
  const Plant start = plant_at(start_x_m);
  const Plant robot = plant_at(x_m);
  RobotDevices devices(options, 0, start.robot(0));
  size_t bytes = 0;
  for (uint64_t tick = 1; tick <= kTickRate_hz; ++tick) {
    devices.exchange_radio(tick * kTickPeriod_us, robot.robot(0));
    bytes += devices.uplink().receive(tick * kTickPeriod_us, kRadioInCapacity).size();
  }
  return bytes;
}

TEST(RobotDevices, TheRobotIsLaidOnItsSideInItsTickAndInNoOther) {
  WorldOptions options;
  options.robots[0].lay_on_side_at_s = 0.03;
  Plant plant = plant_at(0.0);
  RobotDevices devices(options, 0, plant.robot(0));
  devices.execute_events(1, plant.robot(0));
  devices.execute_events(2, plant.robot(0));
  EXPECT_NEAR(roll_deg(plant), 0.0, 1e-6);
  devices.execute_events(3, plant.robot(0));
  EXPECT_NEAR(std::abs(roll_deg(plant)), 90.0, 1.0);

  Plant upright = plant_at(0.0);
  devices.execute_events(4, upright.robot(0));
  EXPECT_NEAR(roll_deg(upright), 0.0, 1e-6);
}

TEST(RobotDevices, NothingIsScriptedUnlessAskedFor) {
  Plant plant = plant_at(0.0);
  RobotDevices devices(WorldOptions{}, 0, plant.robot(0));
  for (uint64_t tick = 0; tick < 100; ++tick) devices.execute_events(tick, plant.robot(0));
  EXPECT_NEAR(roll_deg(plant), 0.0, 1e-6);
}

TEST(RobotDevices, TheRadioReachesAsFarAsTheRobotIsFromItsStart) {
  const size_t near = bytes_received(0.0, 0.0);
  EXPECT_GT(near, 50U);
  EXPECT_EQ(bytes_received(0.0, 1.5), near);
  EXPECT_EQ(bytes_received(0.0, 1000.0), 0U);
  EXPECT_EQ(bytes_received(1000.0, 1000.0), near);
  EXPECT_EQ(bytes_received(1000.0, 0.0), 0U);
}

TEST(RobotDevices, WhatTheRobotSendsReachesGroundStationAndLog) {
  std::ostringstream log;
  const Plant plant = plant_at(0.0);
  WorldOptions options;
  options.robots[0].telemetry_log = &log;
  RobotDevices devices(options, 0, plant.robot(0));
  CanFrame frame = frame_of(message::Heartbeat{0, 0, 0, kFirstBootEpoch, 0});
  e2e_protect(frame.id, 0, frame.data, frame.size);
  uint8_t line[kSlcanLineMax];
  devices.downlink().send(0, {line, slcan_encode(frame, line)});
  for (uint64_t tick = 1; tick <= 10; ++tick) {
    devices.exchange_radio(tick * kTickPeriod_us, plant.robot(0));
  }
  EXPECT_EQ(devices.ground_station().frames(), 1U);
  EXPECT_TRUE(devices.ground_station().report().heard);
  EXPECT_NE(log.str(), "");
}

TEST(RobotDevices, AnEncoderCountsTurnsOfItsShaft) {
  WorldOptions options;
  options.encoder_counts_per_turn = 100.0;
  Plant plant = plant_at(0.0);
  const RobotDevices devices(options, 0, plant.robot(0));
  for (int step = 0; step < 200; ++step) testing::step_one(plant, {0.5, -0.5});
  for (const Side side : {kLeft, kRight}) {
    const double turns = plant.robot(0).vehicle().shaft_angle_rad(side) / (2.0 * std::numbers::pi);
    EXPECT_GT(std::abs(turns), 0.1);
    EXPECT_DOUBLE_EQ(devices.encoder_position(plant.robot(0), side), turns * 100.0);
  }
  EXPECT_GT(devices.encoder_position(plant.robot(0), kLeft), 0.0);
  EXPECT_LT(devices.encoder_position(plant.robot(0), kRight), 0.0);
}

TEST(World, HasOptionsForEachOfItsRobots) {
  WorldOptions options;
  options.robots.resize(2);
  EXPECT_THROW(
      World(std::make_unique<Plant>(HeightField::flat(2.0, 0.1), rover5(), options), options),
      InputError);
}

}  // namespace
}  // namespace screed
