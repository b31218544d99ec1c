// End to end without hardware: the program, the real avrdude, and a stand-in for the bootloader.
// SCREED_FLASH_PROGRAM names the program, SCREED_FLASH_IMAGE the image for the robot.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "tests/flash/caterina_stand_in.h"
#include "tests/flash/fake_usb.h"
#include "tools/flash/child_process.h"

namespace screed::flash {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr UsbId kSketch{0x1FFB, 0x2300};
constexpr UsbId kBootloader{0x1FFB, 0x0101};

std::string from_environment(const char* name) {
  const char* value = std::getenv(name);
  if (value == nullptr) throw std::runtime_error(std::string(name) + " is not set: use make test");
  return value;
}

ChildOutcome run(const Words& command) {
  return run_child(command, std::chrono::minutes(2), [](std::string_view) { return true; });
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

class FlashProgram : public ::testing::Test {
 protected:
  void SetUp() override { program_ = from_environment("SCREED_FLASH_PROGRAM"); }

  /// `screed_flash ARGUMENTS` in the made-up USB tree.
  ChildOutcome screed_flash(const Words& arguments) {
    Words command = {program_};
    command.insert(command.end(), arguments.begin(), arguments.end());
    command.insert(command.end(), {"--sys", usb_.roots().sys, "--dev", usb_.roots().dev});
    return run(command);
  }
  ChildOutcome flash(const fs::path& image, const Words& more) {
    Words arguments = {"write", image, "--mcu", "atmega32u4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return screed_flash(arguments);
  }
  ChildOutcome fuses(const Words& more) {
    Words arguments = {"fuses", "--mcu", "atmega32u4"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return screed_flash(arguments);
  }

  /// A HEX file of `size` bytes, no two pages alike.
  fs::path image_of(std::size_t size) {
    const fs::path binary = usb_.folder() / "image.bin";
    std::ofstream out(binary, std::ios::binary);
    for (std::size_t i = 0; i < size; ++i) out.put(static_cast<char>(i * 7 + i / 128));
    out.close();
    fs::path hex = usb_.folder() / "image.hex";
    EXPECT_EQ(run({"avr-objcopy", "-I", "binary", "-O", "ihex", binary, hex}).exit_code, 0);
    return hex;
  }

  /// The bytes of a HEX file, according to binutils.
  std::vector<std::uint8_t> bytes_of(const fs::path& hex) {
    const fs::path binary = usb_.folder() / "expected.bin";
    EXPECT_EQ(run({"avr-objcopy", "-I", "ihex", "-O", "binary", hex, binary}).exit_code, 0);
    std::ifstream in(binary, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  /// An avrdude that only writes down how it was called, and reads these fuses.
  fs::path recording_avrdude() {
    fs::path script = usb_.folder() / "avrdude";
    std::ofstream(script) << "#!/bin/sh\necho \"$@\" >> " << calls().string()
                          << "\nprintf '0xff\\n0xd0\\n0xf8\\n0xef\\n'\n";
    fs::permissions(script, fs::perms::owner_all);
    return script;
  }
  fs::path calls() const { return usb_.folder() / "calls"; }
  std::string recorded_calls() const {
    std::ifstream in(calls());
    return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  }

  std::string program_;
  FakeUsb usb_;
};

TEST_F(FlashProgram, WritesTheRobotsImageAndNothingElse) {
  const fs::path image = from_environment("SCREED_FLASH_IMAGE");
  const auto expected = bytes_of(image);
  ASSERT_GT(expected.size(), 1000U);

  CaterinaStandIn board;
  const auto outcome = flash(image, {"--port", board.port()});
  board.stop();

  ASSERT_EQ(outcome.exit_code, 0) << outcome.said;
  EXPECT_TRUE(
      contains(outcome.said, std::to_string(expected.size()) + " bytes written and verified"))
      << outcome.said;
  const auto& flashed = board.flash();
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), flashed.begin()));
  const auto end_of_image = flashed.begin() + static_cast<std::ptrdiff_t>(expected.size());
  const auto boot_section = flashed.begin() + CaterinaStandIn::kBootSection;
  EXPECT_TRUE(std::all_of(end_of_image, boot_section, [](unsigned b) { return b == 0xFF; }));
  EXPECT_TRUE(std::all_of(boot_section, flashed.end(), [](unsigned b) { return b == 0x5A; }));
  EXPECT_TRUE(std::all_of(board.eeprom().begin(), board.eeprom().end(),
                          [](unsigned b) { return b == 0xE7; }));
  EXPECT_EQ(board.complaint(), "");
  EXPECT_LT(board.commands().find('e'), board.commands().find('B'));  // erased before written
  EXPECT_EQ(board.commands().back(), 'E');                            // and the sketch started
}

TEST_F(FlashProgram, TouchesTheSketchAndFindsTheBootloader) {
  const fs::path image = image_of(1000);
  const SketchPort sketch;
  CaterinaStandIn board;
  usb_.plug_in("1-1", kSketch, "ttyACM0", sketch.port());
  bool touched = false;
  std::thread robot([&] {
    sketch.wait_until_closed();
    touched = sketch.touched();
    usb_.unplug("1-1", "ttyACM0");
    usb_.plug_in("1-1", kBootloader, "ttyACM1", board.port());
  });
  const auto outcome = flash(image, {});
  close(open(sketch.port().c_str(), O_RDWR | O_NOCTTY));  // lets the robot go if nobody touched it
  robot.join();
  board.stop();
  EXPECT_TRUE(touched);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.said;
  const auto expected = bytes_of(image);
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), board.flash().begin()));
}

TEST_F(FlashProgram, AByteThatCannotBeWrittenIsNamed) {
  CaterinaStandIn::Behaviour behaviour;
  behaviour.worn_address = 0x0123;
  CaterinaStandIn board(behaviour);
  const auto outcome = flash(image_of(1000), {"--port", board.port()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said, "verification failed at address 0x0123: the board has 0xff"))
      << outcome.said;
}

TEST_F(FlashProgram, AWrongChipIsLeftAsItIs) {
  CaterinaStandIn::Behaviour behaviour;
  behaviour.signature = {0x1E, 0x94, 0x88};  // ATmega16U4
  CaterinaStandIn board(behaviour);
  const auto outcome = flash(image_of(1000), {"--port", board.port()});
  board.stop();
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said,
                       "wrong chip: its signature is 1E 94 88, that of an ATmega32U4 is 1E 95 87"))
      << outcome.said;
  EXPECT_TRUE(std::all_of(board.flash().begin(), board.flash().end(),
                          [](unsigned b) { return b == 0x5A; }));
}

TEST_F(FlashProgram, ABootloaderThatDiesHalfWayEndsInBoundedTime) {
  CaterinaStandIn::Behaviour behaviour;
  behaviour.dies_after_blocks = 3;
  CaterinaStandIn board(behaviour);
  const auto outcome = flash(image_of(1000), {"--port", board.port(), "--idle-timeout", "1"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said, "no answer from " + board.port().string() + " half-way"))
      << outcome.said;
}

TEST_F(FlashProgram, APortWithoutABootloaderEndsInBoundedTime) {
  CaterinaStandIn::Behaviour behaviour;
  behaviour.dies_after_blocks = 0;
  CaterinaStandIn board(behaviour);
  const auto outcome = flash(image_of(1000), {"--port", board.port(), "--idle-timeout", "1"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said, "is it a bootloader")) << outcome.said;
}

// avrdude 7.1 goes on for minutes after the bootloader has stopped answering, one line every 5 s.
TEST_F(FlashProgram, EndsAvrdudeAtItsFirstTimeOut) {
  CaterinaStandIn board;
  const fs::path script = usb_.folder() / "avrdude";
  std::ofstream(script) << "#!/bin/sh\necho 'avrdude: erasing chip'\n"
                        << "while :; do echo 'avrdude error: programmer is not responding'; done\n";
  fs::permissions(script, fs::perms::owner_all);
  const auto outcome = flash(image_of(1000), {"--port", board.port(), "--avrdude", script});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said, "half-way")) << outcome.said;
}

TEST_F(FlashProgram, ASketchThatIgnoresTheTouchEndsInBoundedTime) {
  const SketchPort sketch;
  usb_.plug_in("1-1", kSketch, "ttyACM0", sketch.port());
  const auto outcome = flash(image_of(1000), {"--touch-wait", "0.1"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said, "no bootloader: ")) << outcome.said;
}

TEST_F(FlashProgram, WithoutABoardItSaysSo) {
  const auto outcome = flash(image_of(1000), {});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said, "no board found")) << outcome.said;
}

TEST_F(FlashProgram, WithoutAnImageItSaysSo) {
  const auto outcome = flash("no_such.hex", {});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_EQ(outcome.said, "screed_flash: no image no_such.hex: make firmware builds it\n");
}

TEST_F(FlashProgram, WithoutAvrdudeItSaysSo) {
  CaterinaStandIn board;
  const auto outcome =
      flash(image_of(1000), {"--port", board.port(), "--avrdude", "no_such_avrdude"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said, "no_such_avrdude is not installed")) << outcome.said;
}

TEST_F(FlashProgram, PrintsThePortForTheMonitor) {
  usb_.plug_in("1-1", kSketch, "ttyACM4");
  const auto outcome = screed_flash({"port"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.said, usb_.device("ttyACM4").string() + "\n");
}

TEST_F(FlashProgram, ReadsFusesThroughTheBootloader) {
  CaterinaStandIn board;
  const auto outcome = fuses({"--programmer", "avr109", "--port", board.port()});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.said;
  EXPECT_TRUE(contains(outcome.said, "extended fuse: should be 0xC8, is 0xF8")) << outcome.said;
  EXPECT_TRUE(contains(outcome.said, "the fuses are right")) << outcome.said;
}

TEST_F(FlashProgram, NamesTheFusesThatDiffer) {
  CaterinaStandIn::Behaviour behaviour;
  behaviour.high_fuse = 0xD8;      // EEPROM lost at an erase
  behaviour.extended_fuse = 0xFB;  // brown-out at 2.6 V
  CaterinaStandIn board(behaviour);
  const auto outcome = fuses({"--programmer", "avr109", "--port", board.port()});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_TRUE(contains(outcome.said, "differ from what they should be: high, extended\n"))
      << outcome.said;
}

TEST_F(FlashProgram, TheBootloaderCannotWriteFuses) {
  CaterinaStandIn board;
  const auto outcome = fuses({"--programmer", "avr109", "--port", board.port(), "--write"});
  EXPECT_EQ(outcome.exit_code, 2);
  board.stop();
  EXPECT_EQ(board.commands(), "");
}

TEST_F(FlashProgram, WithoutAProgrammerFusesAreOnlyPrinted) {
  const auto outcome = fuses({"--avrdude", recording_avrdude()});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_TRUE(contains(outcome.said,
                       "-U lfuse:w:0xFF:m -U hfuse:w:0xD0:m -U efuse:w:0xC8:m "
                       "-U lock:w:0xEF:m"))
      << outcome.said;
  EXPECT_TRUE(contains(outcome.said, "bootloader at 0x7000, EEPROM survives an erase"))
      << outcome.said;
  EXPECT_TRUE(contains(outcome.said, "brown-out reset 4.3 V")) << outcome.said;
  EXPECT_FALSE(fs::exists(calls()));
}

TEST_F(FlashProgram, AnIspProgrammerReadsUnlessToldToWrite) {
  const Words programmer = {"--programmer", "usbasp", "--avrdude", recording_avrdude()};
  EXPECT_EQ(fuses(programmer).exit_code, 0);
  EXPECT_EQ(
      recorded_calls(),
      "-p atmega32u4 -c usbasp -qq -U lfuse:r:-:h -U hfuse:r:-:h -U efuse:r:-:h -U lock:r:-:h\n");
  fs::remove(calls());
  Words writing = programmer;
  writing.emplace_back("--write");
  EXPECT_EQ(fuses(writing).exit_code, 0);
  EXPECT_TRUE(contains(recorded_calls(), "-U efuse:w:0xC8:m -U lock:w:0xEF:m\n-p "))
      << recorded_calls();  // the lock byte last, then read back
}

}  // namespace
}  // namespace screed::flash
