// Logs of CAN frames: lines as candump writes them, and whatever else a file may hold.
#include "host_sim/ground_station/telemetry/candump_log.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "host_sim/core/errors.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

TEST(CandumpLog, WritesTheLinesOfCandump) {
  // An example of the manual of can-utils.
  const CanFrame frame = {0x044, 5, {0x2A, 0x36, 0x6C, 0x2B, 0xBA}};
  EXPECT_EQ(candump_line(1436509052249713, "vcan0", frame),
            "(1436509052.249713) vcan0 044#2A366C2BBA\n");
  EXPECT_EQ(candump_line(10000, "screed0", {0x7FF, 0, {}}), "(0000000000.010000) screed0 7FF#\n");
}

TEST(CandumpLog, ReadsWhatItWrites) {
  for (uint16_t id = 0; id < 0x800; id = static_cast<uint16_t>(id + 7)) {
    CanFrame frame{id, static_cast<uint8_t>(id % 9), {}};
    for (uint8_t i = 0; i < frame.size; ++i) frame.data[i] = static_cast<uint8_t>(id * 31 + i);
    std::string line = candump_line(1700000000000000U + id, "can0", frame);
    line.pop_back();
    LoggedFrame logged;
    ASSERT_EQ(parse_candump_line(line, logged), LineKind::kFrame) << line;
    EXPECT_EQ(logged.time_us, 1700000000000000U + id);
    EXPECT_EQ(logged.frame.id, id);
    EXPECT_EQ(logged.frame.size, frame.size);
    EXPECT_EQ(std::memcmp(logged.frame.data, frame.data, sizeof frame.data), 0);
  }
}

TEST(CandumpLog, TellsFramesOthersAndTheUnreadable) {
  const struct {
    const char* line;
    LineKind kind;
  } cases[] = {
      {"(1436509052.249713) vcan0 044#2A366C2BBA", LineKind::kFrame},
      {"(1436509052.249713) vcan0 044#2a366c2bba\r", LineKind::kFrame},
      {"(1436509052.249713) vcan0 044#2A R", LineKind::kFrame},  // candump -x
      {"(1436509052.249713) vcan0 044#2A T", LineKind::kFrame},
      {"(0.000000) c 000#", LineKind::kFrame},
      {"(1436509052.249713) vcan0 044#R", LineKind::kOtherFrame},
      {"(1436509052.249713) vcan0 044#R8", LineKind::kOtherFrame},
      {"(1436509052.249713) vcan0 044##1A2B", LineKind::kOtherFrame},
      {"(1436509052.249713) vcan0 12345678#00", LineKind::kOtherFrame},
      {"(1436509052.249713) vcan0 20000004#0001000000000000", LineKind::kOtherFrame},
      {"(1436509052.249713) vcan0 844#2A", LineKind::kUnreadable},  // 12 bits
      {"(1436509052.249713) vcan0 044#2A3", LineKind::kUnreadable},
      {"(1436509052.249713) vcan0 044#2A3G", LineKind::kUnreadable},
      {"(1436509052.249713) vcan0 044#2A366C2BBA00112233", LineKind::kUnreadable},
      {"(1436509052.249713) vcan0 044", LineKind::kUnreadable},
      {"(1436509052.249713) vcan0 04#2A", LineKind::kUnreadable},
      {"(1436509052.249713) vcan0 044#R8X", LineKind::kUnreadable},
      {"(1436509052.249713) 044#2A", LineKind::kUnreadable},
      {"(1436509052.249713)  044#2A", LineKind::kUnreadable},
      {"(1436509052.249713)  can0 044#2A", LineKind::kFrame},  // beside slcan0
      {"(1436509052.249713456) can0 044#2A", LineKind::kFrame},
      {"(2015-07-10 06:17:32.249713) can0 044#2A", LineKind::kFrame},
      {"(2015-13-10 06:17:32.249713) can0 044#2A", LineKind::kUnreadable},
      {"(2015-02-29 06:17:32.249713) can0 044#2A", LineKind::kUnreadable},
      {"(2015-07-10 24:17:32.249713) can0 044#2A", LineKind::kUnreadable},
      {"(2015-07-10T06:17:32.249713) can0 044#2A", LineKind::kUnreadable},
      {"(1436509052.2497134) can0 044#2A", LineKind::kUnreadable},
      {"(1436509052.249713)can0 044#2A", LineKind::kUnreadable},
      {" (1436509052.249713)  vcan0  044   [1]  2A", LineKind::kFrame},
      {" (1436509052.249713)  vcan0  044   [1]  2A  '*'", LineKind::kFrame},
      {" (1436509052.249713)  vcan0  RX B -  044   [1]  2A", LineKind::kFrame},
      {" (1436509052.249713)  vcan0  044   [0] ", LineKind::kFrame},
      {" (1436509052.249713)  vcan0  044   [0]  remote request", LineKind::kOtherFrame},
      {" (1436509052.249713)  vcan0  044  [12]  00 11 22 33", LineKind::kOtherFrame},
      {" (1436509052.249713)  vcan0  12345678   [1]  2A", LineKind::kOtherFrame},
      {" (1436509052.249713)  vcan0  044   [2]  2A", LineKind::kUnreadable},
      {" (1436509052.249713)  vcan0  044   [1]  2A 36", LineKind::kUnreadable},
      {" (1436509052.249713)  vcan0  044   [1]  2G", LineKind::kUnreadable},
      {" (1436509052.249713)  vcan0  044   2A", LineKind::kUnreadable},
      {"vcan0 044#2A", LineKind::kUnreadable},
      {"(1436509052.2497) vcan0 044#2A", LineKind::kUnreadable},
      {"(1436509052) vcan0 044#2A", LineKind::kUnreadable},
      {"(9999999999999.000000) vcan0 044#2A", LineKind::kUnreadable},
      {" vcan0  044   [1]  2A", LineKind::kUntimed},  // candump without -L and -t
      {"t2101AA", LineKind::kUnreadable},
      {"", LineKind::kUnreadable},
  };
  for (const auto& one : cases) {
    LoggedFrame frame;
    EXPECT_EQ(parse_candump_line(one.line, frame), one.kind) << one.line;
  }
}

TEST(CandumpLog, TimesAndDataAreThoseOfTheLogFormatHoweverTheyAreWritten) {
  for (const char* line :
       {"(1436509052.249713) can0 044#2A366C", "(1436509052.249713999)   can0 044#2A366C",
        "(2015-07-10 06:17:32.249713) can0 044#2A366C",  // date -ud @1436509052
        " (1436509052.249713)  can0  044   [3]  2A 36 6C",
        " (2015-07-10 06:17:32.249713)  can0  TX - -  044   [3]  2A 36 6C  '*6l'"}) {
    LoggedFrame logged;
    ASSERT_EQ(parse_candump_line(line, logged), LineKind::kFrame) << line;
    EXPECT_EQ(logged.time_us, 1436509052249713U) << line;
    EXPECT_EQ(logged.frame.id, 0x044) << line;
    ASSERT_EQ(logged.frame.size, 3) << line;
    const uint8_t expected[8] = {0x2A, 0x36, 0x6C};
    EXPECT_EQ(std::memcmp(logged.frame.data, expected, 8), 0) << line;
  }
}

TEST(CandumpLog, AWriterBeginsANewLineAfterACutOne) {
  const TempFolder folder;
  const std::string path = (folder.path() / "drive.log").string();
  const char* const cases[][2] = {{"(1.000000) a 044#2A\n", "(1.000000) a 044#2A\n"},
                                  {"(1.000000) a 044#2", "(1.000000) a 044#2\n"},
                                  {"", ""}};
  for (const auto& [before, kept] : cases) {
    std::ofstream(path, std::ios::binary) << before;
    CandumpWriter writer(path, "/dev/ttyUSB0");
    writer.add(2'000'000, {});
    EXPECT_EQ(read_text(path), std::string(kept) + "(0000000002.000000) ttyUSB0 000#\n");
  }
}

TEST(CandumpLog, AClockThatIsSetHidesNoTimeAndIsToldOnce) {
  LogClock clock;
  EXPECT_EQ(clock.add(5'000'000, 1), 0U);
  EXPECT_EQ(clock.add(5'200'000, 2), 200'000U);
  EXPECT_EQ(clock.add(5'100'000, 3), 0U) << "two interfaces out of order";
  EXPECT_EQ(clock.add(5'300'000, 4), 100'000U);
  EXPECT_EQ(clock.text(), "");
  EXPECT_EQ(clock.add(4'300'000, 5), 0U);
  EXPECT_EQ(clock.add(4'400'000, 6), 100'000U);
  EXPECT_EQ(clock.text(), "the clock of the log steps back by 1 s at line 5");
  EXPECT_EQ(clock.add(1'004'400'000, 7), 0U);
  EXPECT_EQ(clock.add(1'004'500'000, 8), 100'000U);
  EXPECT_EQ(clock.elapsed_us(), 500'000U);
  EXPECT_EQ(clock.text(),
            "the clock of the log steps back by 1 s at line 5 (and 1 more such steps)");
  LogClock ahead;
  ahead.add(0, 1);
  ahead.add(60'000'000, 2);
  EXPECT_EQ(ahead.elapsed_us(), 60'000'000U) << "a silence";
  ahead.add(1'060'000'000, 3);
  EXPECT_EQ(ahead.text(),
            "the clock of the log steps ahead by 1000 s at line 3, or nothing was "
            "recorded for so long");
}

class CandumpReading : public ::testing::Test {
 protected:
  /// Frames and unreadable lines of a file of this content.
  struct Content {
    std::vector<LoggedFrame> frames;
    std::vector<uint64_t> unreadable;
  };
  Content read(const std::string& text) {
    const std::string path = (scratch_.path() / "log").string();
    std::ofstream(path, std::ios::binary) << text;
    CandumpReader reader(path);
    Content content;
    LineKind kind{};
    LoggedFrame frame;
    while (reader.next(kind, frame)) {
      if (kind == LineKind::kFrame) content.frames.push_back(frame);
      if (kind == LineKind::kUnreadable) content.unreadable.push_back(reader.line_number());
    }
    return content;
  }
  TempFolder scratch_;
};

const std::string kLine = "(0000000001.000000) can0 123#00\n";

TEST_F(CandumpReading, EmptyLinesAndAMissingLastEnd) {
  EXPECT_TRUE(read("").frames.empty());
  EXPECT_TRUE(read("\n\r\n\n").unreadable.empty());
  const Content content = read("\n" + kLine + "\n" + kLine.substr(0, kLine.size() - 1));
  EXPECT_EQ(content.frames.size(), 2U);
  EXPECT_TRUE(content.unreadable.empty());
}

TEST_F(CandumpReading, ALastLineCutAnywhereIsNoOtherFrame) {
  for (size_t length = 1; length + 1 < kLine.size(); ++length) {
    const Content content = read(kLine + kLine.substr(0, length));
    for (size_t i = 0; i < content.frames.size(); ++i) {
      EXPECT_EQ(content.frames[i].frame.id, 0x123);
      EXPECT_EQ(content.frames[i].frame.size, i == 0 ? 1 : 0);
    }
    EXPECT_EQ(content.frames.size() + content.unreadable.size(), 2U) << length;
  }
}

TEST_F(CandumpReading, BytesOfAnyKindAreCountedByLines) {
  const std::string nonsense("\0\xFF(\x80\n", 5);
  const Content content = read(kLine + nonsense + kLine + nonsense + nonsense + kLine);
  EXPECT_EQ(content.frames.size(), 3U);
  EXPECT_EQ(content.unreadable, (std::vector<uint64_t>{2, 4, 5}));
}

TEST_F(CandumpReading, LinesLongerThanTheBufferAreOneUnreadableLine) {
  for (const size_t size : {size_t{1} << 20U, (size_t{1} << 20U) + 1, size_t{5} << 20U}) {
    const std::string nonsense(size, 'x');
    std::string text = kLine;
    text.append(nonsense).append("\n").append(kLine);
    const Content content = read(text);
    EXPECT_EQ(content.frames.size(), 2U) << size;
    EXPECT_EQ(content.unreadable, (std::vector<uint64_t>{2})) << size;
    EXPECT_EQ(read(nonsense).unreadable.size(), 1U) << size;
  }
}

TEST_F(CandumpReading, LinesThatSpanTheBuffersEndAreWhole) {
  std::string text;
  for (int i = 0; i < 80000; ++i) text += kLine;  // 2.5 MB
  const Content content = read(text);
  EXPECT_EQ(content.frames.size(), 80000U);
  EXPECT_TRUE(content.unreadable.empty());
}

TEST_F(CandumpReading, AFileThatIsNotThereIsSaid) {
  EXPECT_THROW(CandumpReader("/nowhere/at/all"), InputError);
  CandumpReader folder(scratch_.path().string());
  LineKind kind{};
  LoggedFrame frame;
  EXPECT_THROW(folder.next(kind, frame), InputError);
}

}  // namespace
}  // namespace screed
