// Every board's image on its board: it boots, ticks, hears its encoders, and drives the right motor
// in the right direction.
#include <gtest/gtest.h>

#include "firmware/parameters/parameter_store.h"
#include "host_sim/devices/mcu/board.h"
#include "host_sim/run/experiment/board_table.h"
#include "tests/mcu/ground_lines.h"
#include "tests/mcu/images_of_boards.h"

namespace screed::mcu {
namespace {

class EachBoard : public ::testing::TestWithParam<std::string> {
 protected:
  EachBoard() : board_(image_of(GetParam()), wiring_of(GetParam())) {
    board_.set_encoder(kLeft, 0);
    board_.set_encoder(kRight, 0);
  }

  /// A level robot at rest, with a little noise.
  void run_ms(int ms) {
    for (int i = 0; i < ms; ++i, ++ms_) {
      const int noise = ms_ % 7 - 3;
      board_.set_acceleration(0.244 * Eigen::Vector3d(noise, -noise, 4096 + noise));
      board_.set_magnetic_field(0.160 * Eigen::Vector3d(noise, 1250, -2500 + noise));
      board_.set_angular_rate(0.070 * Eigen::Vector3d(noise, 2 - noise, ms_ % 5 - 2));
      if (ms_ % 100 == 0) board_.mcu.receive(ground_.heartbeat(static_cast<std::uint32_t>(ms_)));
      board_.mcu.run_ms(1);
    }
  }

  /// Exactly; what the program shows breaks a run off.
  void run_until(std::uint64_t cycle) {
    while (board_.mcu.cycle() < cycle && board_.mcu.alive()) board_.mcu.run_to(cycle);
  }

  CanFrame last(std::uint16_t id) {
    CanFrame result{};
    bool found = false;
    for (const CanFrame& frame : frames_in(board_.mcu.sent())) {
      if (frame.id == id) result = frame;
      found = found || frame.id == id;
    }
    EXPECT_TRUE(found) << "no frame " << std::hex << id;
    return result;
  }

  Board board_;
  GroundLines ground_;
  int ms_ = 0;
};

TEST_P(EachBoard, BootsAndTicks) {
  run_ms(2000);
  EXPECT_TRUE(board_.mcu.alive());
  EXPECT_EQ(board_.mcu.starts(), 1);
  EXPECT_NEAR(static_cast<double>(board_.mcu.ticks()), 199, 2);
  EXPECT_EQ(board_.motor_duty_ratio(kLeft), 0.0);
  EXPECT_EQ(board_.motor_duty_ratio(kRight), 0.0);
  EXPECT_NEAR(get_s16(last(kIdAccelRaw).data + 6), 4096, 5);
  EXPECT_NEAR(get_u16(last(kIdPower).data + 2), 7200, 40);
}

TEST_P(EachBoard, MissesNoEdgeAtThreeTimesTheFastest) {
  run_ms(300);
  // 0.75 m/s on both tracks. The Rover 5 has 565.5 um a count, the Zumo 131.2 um: 1330 and 5700
  // counts/s, an edge of one side every 750 and 175 us. The other side runs backwards and a little
  // slower.
  const std::uint64_t step_cycles = GetParam() == "zumo_32u4" ? 2800 : 12'000;
  std::int64_t left = 0;
  std::int64_t right = 0;
  for (std::uint64_t i = 0; i < 6000; ++i) {
    // The simulator may overshoot: the next edge is counted from this one. The sides drift past
    // each other.
    const std::uint64_t now = board_.mcu.cycle();
    board_.set_encoder(kLeft, ++left);
    run_until(now + 200 + 40 * (i % 60));
    if (i % 20 != 0) board_.set_encoder(kRight, --right);
    run_until(now + step_cycles);
  }
  run_until(board_.mcu.cycle() + kClock_hz / 10);
  EXPECT_EQ(get_u16(last(kIdEncoders).data + 2), static_cast<std::uint16_t>(left));
  EXPECT_EQ(get_u16(last(kIdEncoders).data + 4), static_cast<std::uint16_t>(right));
  EXPECT_EQ(last(kIdMotors).data[6], 0) << "missed edges";
  EXPECT_EQ(board_.mcu.starts(), 1);
}

TEST_P(EachBoard, CountsAMissedEdge) {
  run_ms(200);
  for (const Side side : {kLeft, kRight}) {
    const std::uint8_t before = last(kIdMotors).data[6];
    board_.set_encoder(side, 1);
    run_until(board_.mcu.cycle() + 4);
    board_.set_encoder(side, 2);  // before the program can look
    run_ms(100);
    EXPECT_EQ(last(kIdMotors).data[6], before + 1);
  }
}

TEST_P(EachBoard, TurnsLeftWithTheRightTrackForward) {
  Parameters parameters;
  parameters.algorithm() = 0;  // drives as the ground station says
  ParameterCopy copy{};
  encode_parameters(parameters, 1, copy);
  board_.mcu.write_eeprom(parameter_copy_address(0), copy.bytes);
  board_.mcu.write_eeprom(kCredentialRecordAddress,
                          credential_record(credentials_of(test_key())).bytes);
  run_ms(6000);
  board_.mcu.receive(ground_.command(CommandOp::kArm));
  run_ms(50);
  board_.mcu.receive(ground_.command(CommandOp::kRun));
  run_ms(50);
  board_.mcu.receive(ground_.command(CommandOp::kDrive, {0, 600}));
  run_ms(100);
  EXPECT_LT(board_.motor_duty_ratio(kLeft), 0.0);
  EXPECT_GT(board_.motor_duty_ratio(kRight), 0.0);
}

INSTANTIATE_TEST_SUITE_P(Boards, EachBoard, ::testing::ValuesIn(board_names()),
                         [](const auto& it) { return it.param; });

}  // namespace
}  // namespace screed::mcu
