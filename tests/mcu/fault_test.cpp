// Faults of the hardware under the image that is flashed, driving in the world: the robot stops in
// time, the tick keeps its deadline, and the cause is reported to the ground station.
#include <gtest/gtest.h>

#include "firmware/protocol/messages.h"
#include "firmware/robot/supervisor.h"
#include "tests/mcu/image_drive.h"

namespace screed::mcu {
namespace {

constexpr std::uint16_t kChipFaults = Fault::kAccelMagChip | Fault::kGyroChip;

I2cChip& chip_of(ImageDrive& drive, uint8_t bit) {
  Board& board = drive.board();
  if (bit == ChipBit::kAccelMagChip) return board.accel_mag;
  if (bit == ChipBit::kGyroChip) return board.gyro;
  return *board.baro;
}

// 13
TEST(Fault, ADeviceInTheMiddleOfAByteIsClockedFreeWithin25Ms) {
  ImageDrive drive;
  drive.set_off();
  for (const unsigned clocks : {1U, 5U, 9U}) {
    drive.board().bus.hold_data(clocks);
    const std::optional<double> freed =
        drive.ms_until([&] { return !drive.board().bus.data_held(); }, 1.0);
    ASSERT_TRUE(freed.has_value());
    EXPECT_LE(*freed, 25.0) << clocks << " clocks";
    drive.run(1.0);
    EXPECT_TRUE(drive.powered()) << "no reason to stop";
    EXPECT_EQ(drive.report().state, RobotState::kRunning);
  }
  drive.expect_punctual();
}

// 14
TEST(Fault, AChipAbsentAtBootKeepsTheRobotFromBeingArmed) {
  for (const uint8_t bit : {ChipBit::kAccelMagChip, ChipBit::kGyroChip}) {
    ImageDrive drive;
    chip_of(drive, bit).present = false;
    for (int i = 0; i < 1200; ++i) {
      drive.tick();
      ASSERT_FALSE(drive.powered());
    }
    EXPECT_EQ(drive.report().state, RobotState::kDisarmed);
    EXPECT_EQ(drive.failing_chips(), bit) << "says which chip";
    drive.expect_punctual();
    const std::vector<std::uint8_t> ack = drive.last_frame(kIdCommandAck);
    ASSERT_EQ(ack.size(), message::CommandAck::kSize);
    EXPECT_NE(ack[4], static_cast<std::uint8_t>(RequestResult::kDone));
  }
}

TEST(Fault, ABarometerThatFailsIsReportedAndStopsNothing) {
  ImageDrive drive;
  drive.set_off();
  drive.board().baro->present = false;
  drive.run(2.0);
  EXPECT_TRUE(drive.powered());
  EXPECT_EQ(drive.report().state, RobotState::kRunning);
  EXPECT_EQ(drive.failing_chips(), ChipBit::kBaroChip);
  drive.board().baro->present = true;
  drive.run(2.0);
  EXPECT_EQ(drive.failing_chips(), 0);
  drive.expect_punctual();
}

// 15
TEST(Fault, AChipThatVanishesStopsTheRobotWithin100Ms) {
  for (const uint8_t bit : {ChipBit::kAccelMagChip, ChipBit::kGyroChip}) {
    ImageDrive drive;
    drive.set_off();
    chip_of(drive, bit).present = false;
    const std::optional<double> stopped = drive.ms_until_stop();
    ASSERT_TRUE(stopped.has_value());
    EXPECT_LE(*stopped, 100.0);
    drive.run(1.0);
    EXPECT_EQ(drive.report().state, RobotState::kFault);
    EXPECT_EQ(drive.report().faults & kChipFaults, bit << 8);
    EXPECT_EQ(drive.failing_chips(), bit);
    drive.expect_punctual();
  }
}

TEST(Fault, AChipThatLosesItsSettingsStopsTheRobotAndIsConfiguredAgain) {
  ImageDrive drive;
  drive.set_off();
  drive.board().gyro.power_up();
  EXPECT_TRUE(drive.ms_until_stop().has_value());
  drive.run(1.0);
  EXPECT_NE(drive.report().faults & Fault::kGyroChip, 0);
  EXPECT_EQ(drive.failing_chips(), 0);
  EXPECT_NE(drive.sample.fresh & kFreshGyro, 0);
}

// 7
TEST(Fault, AFloodedRadioLineLeavesTheTickAloneAndEndsTheLink) {
  ImageDrive drive;
  drive.set_off();
  const std::uint8_t rejected_before = drive.last_frame(kIdLink).at(4);
  drive.image().flood = true;
  const std::optional<double> stopped = drive.ms_until_stop(4.0);
  ASSERT_TRUE(stopped.has_value());
  EXPECT_LE(*stopped, 1500.0) << "0.5 s without a heartbeat, then the ramp";
  drive.run(2.0);
  EXPECT_EQ(drive.report().state, RobotState::kDisarmed);
  const std::vector<std::uint8_t> heartbeat = drive.last_frame(kIdHeartbeat);
  EXPECT_EQ(heartbeat.at(7), 0) << "link not alive";
  EXPECT_GE(drive.cycles().uart_received, 15000U) << "no flood";
  EXPECT_EQ(drive.cycles().uart_overruns, 0U);
  drive.expect_punctual();
  EXPECT_NE(drive.last_frame(kIdLink).at(4), rejected_before) << "rejected lines are not counted";
  // No arming by itself when the line is free again.
  drive.image().flood = false;
  drive.run(2.0);
  EXPECT_EQ(drive.report().state, RobotState::kDisarmed);
}

}  // namespace
}  // namespace screed::mcu
