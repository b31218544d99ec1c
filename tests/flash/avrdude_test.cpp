// What avrdude says, turned into one line; and how long a program may keep silent. The transcripts
// are avrdude 7.1's own.
#include "tools/flash/avrdude.h"

#include <gtest/gtest.h>

#include <string>

#include "host_sim/core/errors.h"

namespace screed::flash {
namespace {

std::string line_for(const std::string& said, bool killed = false) {
  Avrdude avrdude;
  avrdude.programmer = "avr109";
  avrdude.port = "/dev/ttyACM0";
  return failure_message(avrdude, {1, killed, said});
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(WhatWentWrong, NoRightToOpenThePort) {
  const auto line = line_for(
      "avrdude OS error: cannot open port /dev/ttyACM0: Permission denied\n"
      "avrdude error: unable to open programmer avr109 on port /dev/ttyACM0\n");
  EXPECT_TRUE(contains(line, "no right to open /dev/ttyACM0")) << line;
  EXPECT_TRUE(contains(line, "60-screed.rules")) << line;
}

TEST(WhatWentWrong, PortInUse) {
  const auto line =
      line_for("avrdude OS error: cannot open port /dev/ttyACM0: Device or resource busy\n");
  EXPECT_TRUE(contains(line, "in use")) << line;
}

TEST(WhatWentWrong, AnythingElseIsAvrdudesFirstComplaint) {
  EXPECT_EQ(line_for("\navrdude error: no valid record found in Intel Hex file bad.hex\n"
                     "avrdude error: read from file bad.hex failed\n"),
            "avrdude failed: no valid record found in Intel Hex file bad.hex");
  EXPECT_EQ(line_for("avrdude done.  Thank you.\n"), "avrdude failed: exit code 1");
}

TEST(WhatWentWrong, AStallIsToldApartByHowFarItGot) {
  EXPECT_TRUE(contains(line_for("", true), "first questions"));
  EXPECT_TRUE(contains(line_for("avrdude: erasing chip\n", true), "half-way"));
}

TEST(HexByte, IsReadAndWritten) {
  EXPECT_EQ(hex_byte(0x0A), "0x0A");
  for (const char* right : {"0xd0", "0XD0", "D0"}) EXPECT_EQ(parse_hex_byte(right, "fuse"), 0xD0);
  EXPECT_EQ(parse_hex_byte("0x0", "fuse"), 0);
  for (const char* wrong : {"", "0x", "0x100", "-1", "D0 ", "high"})
    EXPECT_THROW(parse_hex_byte(wrong, "fuse"), InputError) << wrong;
}

TEST(RunChild, TellsOutputAndExitCode) {
  const auto outcome = run_child({"sh", "-c", "echo one; echo two >&2; exit 3"},
                                 std::chrono::seconds(60), [](std::string_view) { return true; });
  EXPECT_FALSE(outcome.killed);
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_EQ(outcome.said, "one\ntwo\n");
}

TEST(RunChild, KillsWhatFallsSilent) {
  const auto outcome =
      run_child({"sh", "-c", "echo one; exec tail -f /dev/null"}, std::chrono::milliseconds(100),
                [](std::string_view) { return true; });
  EXPECT_TRUE(outcome.killed);
}

TEST(RunChild, KillsWhenTheListenerHasHeardEnough) {
  const auto outcome = run_child(
      {"sh", "-c", "echo enough; exec tail -f /dev/null"}, std::chrono::seconds(600),
      [](std::string_view said) { return said.find("enough") == std::string_view::npos; });
  EXPECT_TRUE(outcome.killed);
}

TEST(RunChild, AProgramThatIsNotThereIsNamed) {
  try {
    run_child({"no_such_avrdude"}, std::chrono::seconds(1), [](std::string_view) { return true; });
    FAIL();
  } catch (const RunError& error) {
    EXPECT_TRUE(contains(error.what(), "no_such_avrdude is not installed")) << error.what();
  }
}

}  // namespace
}  // namespace screed::flash
