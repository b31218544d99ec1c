// Faults of the hardware under the image that is flashed: those whose trials take more than two
// seconds. Long: five seconds of a bus that hangs, eight drives with a broken encoder.
#include <gtest/gtest.h>

#include "firmware/protocol/messages.h"
#include "firmware/robot/supervisor.h"
#include "tests/mcu/image_drive.h"

namespace screed::mcu {
namespace {

// 13
TEST(Fault, DataLineHeldLowForFiveSecondsStopsTheRobot) {
  ImageDrive drive;
  drive.set_off();
  drive.board().bus.hold_data();
  const std::optional<double> stopped = drive.ms_until_stop();
  ASSERT_TRUE(stopped.has_value());
  EXPECT_LE(*stopped, 100.0);
  drive.run(5.0);
  EXPECT_FALSE(drive.powered());
  EXPECT_EQ(drive.report().state, RobotState::kFault);
  EXPECT_NE(drive.report().faults & (Fault::kAccelMagChip | Fault::kGyroChip | Fault::kImuSilent),
            0);
  EXPECT_EQ(drive.failing_chips(),
            ChipBit::kAccelMagChip | ChipBit::kGyroChip | ChipBit::kBaroChip);
  drive.expect_punctual();
  // The bus comes back, and with it the numbers; the fault stays latched.
  drive.board().bus.release_data();
  drive.run(1.0);
  EXPECT_EQ(drive.failing_chips(), 0);
  EXPECT_NE(drive.sample.fresh & kFreshGyro, 0);
  EXPECT_EQ(drive.report().state, RobotState::kFault);
  EXPECT_FALSE(drive.powered());
}

struct Broken {
  Side side;
  bool a;
  bool b;
  double speed_m_per_s;
};

// 21
TEST(Fault, ABrokenEncoderStopsTheRobotWithin200Ms) {
  for (const Broken& broken : {Broken{kLeft, true, false, 0.15}, Broken{kLeft, false, true, 0.15},
                               Broken{kRight, true, false, 0.15}, Broken{kRight, false, true, 0.15},
                               Broken{kLeft, true, false, 0.25}, Broken{kRight, false, true, 0.08},
                               Broken{kLeft, true, true, 0.15}, Broken{kRight, true, true, 0.25}}) {
    ImageDrive drive(1, broken.speed_m_per_s);
    drive.set_off();
    Board& board = drive.board();
    if (broken.a) board.break_encoder_wire(broken.side, 0);
    if (broken.b) board.break_encoder_wire(broken.side, 1);
    const std::optional<double> stopped = drive.ms_until_stop();
    ASSERT_TRUE(stopped.has_value());
    EXPECT_LE(*stopped, 200.0) << (broken.side == kLeft ? "left " : "right ") << broken.a
                               << broken.b << " at " << broken.speed_m_per_s;
    drive.run(1.0);
    const std::uint16_t of_side = broken.side == kLeft ? Fault::kEncoderLeft | Fault::kStallLeft
                                                       : Fault::kEncoderRight | Fault::kStallRight;
    EXPECT_EQ(drive.report().state, RobotState::kFault);
    EXPECT_NE(drive.report().faults & of_side, 0);
    EXPECT_EQ(drive.report().faults & ~of_side, 0) << "the other track is well";
    drive.expect_punctual();
  }
}

}  // namespace
}  // namespace screed::mcu
