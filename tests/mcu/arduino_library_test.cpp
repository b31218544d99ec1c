// The example of the Arduino library, built as the Arduino IDE would build it (tools/arduino):
// it is the same program.
#include <gtest/gtest.h>

#include <filesystem>

#include "host_sim/devices/mcu/board.h"
#include "tests/mcu/ground_lines.h"
#include "tests/mcu/images.h"
#include "tests/mcu/usb_host.h"

namespace screed::mcu {
namespace {

std::string example() {
  return (std::filesystem::path(kScreedImage).parent_path().parent_path().parent_path() /
          "arduino/example.elf")
      .string();
}

/// What is felt changes seldom: the two images are a few cycles apart in time, and one that reads
/// while it changes would differ.
void run(Board& board, int ms) {
  for (int i = 0; i < ms; ++i) {
    const int step = i / 45;
    const int noise = step % 7 - 3;
    board.set_acceleration(0.244 * Eigen::Vector3d(noise, -noise, 4096 + noise));
    board.set_angular_rate(0.070 * Eigen::Vector3d(noise, 2 - noise, step % 5 - 2));
    board.mcu.run_ms(1);
  }
}

TEST(ArduinoLibrary, ItsExampleBootsAndSendsHeartbeatsAt5Hz) {
  Board board(example(), read_wiring(kWiring));
  run(board, 3000);
  EXPECT_TRUE(board.mcu.alive());
  EXPECT_EQ(board.mcu.starts(), 1);
  EXPECT_NEAR(static_cast<double>(board.mcu.ticks()), 299, 2);
  int heartbeats = 0;
  for (const CanFrame& frame : frames_in(board.mcu.sent())) heartbeats += frame.id == kIdHeartbeat;
  EXPECT_NEAR(heartbeats, 15, 1);
}

TEST(ArduinoLibrary, ItsExampleSendsTheBytesOfTheFlashedImage) {
  Board flashed(kScreedImage, read_wiring(kWiring));
  Board built(example(), read_wiring(kWiring));
  for (Board* board : {&flashed, &built}) run(*board, 2000);
  // Not the frames that carry what was measured of time: POWER and HEALTH.
  const auto comparable = [](const Board& board) {
    std::vector<std::vector<std::uint8_t>> result;
    for (const CanFrame& frame : frames_in(board.mcu.sent())) {
      if (frame.id == kIdPower || frame.id == kIdHealth) continue;
      result.emplace_back(frame.data, frame.data + frame.size);
    }
    result.resize(std::min<std::size_t>(result.size(), 150));
    return result;
  };
  ASSERT_GE(comparable(flashed).size(), 150U);
  EXPECT_EQ(comparable(built), comparable(flashed));
}

TEST(ArduinoLibrary, ItsExampleIsFlashedOverUsbLikeAnySketch) {
  Board board(example(), read_wiring(kWiring));
  board.mcu.run_ms(50);
  UsbHost usb(board.mcu);
  ASSERT_TRUE(usb.plug_in());
  ASSERT_TRUE(usb.set_line(1200, true));
  ASSERT_TRUE(usb.set_line(1200, false));
  usb.run_ms(20);
  EXPECT_EQ(board.mcu.word(0x0800), 0x7777);
  usb.run_ms(180);
  EXPECT_EQ(board.mcu.starts(), 2);
}

}  // namespace
}  // namespace screed::mcu
