// Logs as messages, tables, MCAP and pictures.
#include <gtest/gtest.h>
#include <zstd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <sstream>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/json.h"
#include "host_sim/ground_station/telemetry/candump_log.h"
#include "tests/temp_folder.h"
#include "tools/screed/link/decode_command.h"
#include "tools/screed/link/plot_command.h"

namespace screed {
namespace {

std::string read_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in) << path;
  return {std::istreambuf_iterator<char>(in), {}};
}

template <typename Message>
CanFrame protected_frame(const Message& message, uint8_t counter, uint8_t node = 1) {
  CanFrame frame = frame_of(message);
  frame.id = id_of_node(frame.id, node);
  e2e_protect(frame.id, counter, frame.data, frame.size);
  return frame;
}

std::string attitude_line(double time_s, int16_t pitch, uint8_t counter, uint8_t node = 1) {
  return candump_line(static_cast<uint64_t>(std::llround(time_s * 1e6)), "can0",
                      protected_frame(message::Attitude{-5, pitch, 35999}, counter, node));
}

class Decode : public ::testing::Test {
 protected:
  std::string log(const std::string& text) {
    std::string path = (scratch_.path() / "radio.log").string();
    std::ofstream(path, std::ios::binary) << text;
    return path;
  }
  DecodeStatistics account_of(const std::string& text) {
    LogDecoder decoder(log(text));
    DecodedFrame frame;
    while (decoder.next(frame)) {
    }
    return decoder.statistics();
  }
  int csv(const std::string& text, bool numbers = false) {
    DecodeOptions options;
    options.log = log(text);
    options.csv = true;
    options.numbers = numbers;
    out_.str("");
    err_.str("");
    return run_decode(options, out_, err_);
  }
  std::string table(const char* name) {
    return read_file(scratch_.path() / "radio_csv" / (std::string(name) + ".csv"));
  }

  TempFolder scratch_;
  std::ostringstream out_;
  std::ostringstream err_;
};

TEST_F(Decode, AccountsForEveryLine) {
  CanFrame wrong = protected_frame(message::Attitude{1, 2, 3}, 3);
  wrong.data[4] ^= 1U;
  CanFrame cut = protected_frame(message::Attitude{1, 2, 3}, 3);
  cut.size = 5;
  const DecodeStatistics statistics = account_of(
      attitude_line(0.1, 1, 0) + attitude_line(0.2, 2, 1) + candump_line(0, "can0", wrong) +
      candump_line(0, "can0", cut) + candump_line(0, "can0", {0x777, 1, {1}}) +
      "(0.000000) can0 044##1A2B\n\nnonsense\n" + attitude_line(0.3, 3, 4) +
      attitude_line(0.3, 3, 4) + attitude_line(0.4, 4, 5, 2) + "(0000000000.4");
  EXPECT_EQ(statistics.lines, 11U);
  EXPECT_EQ(statistics.messages, 5U);
  EXPECT_EQ(statistics.wrong_crcs, 1U);
  EXPECT_EQ(statistics.wrong_sizes, 1U);
  EXPECT_EQ(statistics.unknown_ids, 1U);
  EXPECT_EQ(statistics.other_frames, 1U);
  EXPECT_EQ(statistics.unreadable_lines, 2U);
  EXPECT_EQ(statistics.first_unreadable_line, 8U);
  EXPECT_EQ(statistics.missing, 2U) << "counters 2 and 3 of robot 1; robot 2 counts for itself";
  EXPECT_EQ(statistics.text(),
            "5 messages of 11 lines, 2 unreadable (the first is line 8), 1 of a wrong size, 1 with "
            "a wrong CRC, 1 with ids of others, 1 remote, error, FD or 29-bit frames, 2 messages "
            "missing by their counters");
}

TEST_F(Decode, CountersWrapWithoutALoss) {
  std::string text;
  for (int i = 0; i < 40; ++i) text += attitude_line(i, 0, static_cast<uint8_t>(i % 16));
  EXPECT_EQ(account_of(text).missing, 0U);
  // From 3 to 2 are 14: 4 to 15, 0 and 1.
  EXPECT_EQ(account_of(attitude_line(0.0, 0, 3) + attitude_line(1.0, 0, 2)).missing, 14U);
}

TEST_F(Decode, TablesHaveUnitsAndExactNumbers) {
  message::Heartbeat heartbeat{};
  heartbeat.state = 2;
  heartbeat.faults = 0x1001;
  message::Baro baro = {UINT32_MAX, -1};
  EXPECT_EQ(csv(attitude_line(12.34, 310, 0) + attitude_line(1700000000.25, -9000, 1, 3) +
                candump_line(5, "can0", protected_frame(heartbeat, 0)) +
                candump_line(6, "can0", protected_frame(baro, 0))),
            0);
  EXPECT_EQ(table("attitude"),
            "time [s],robot,roll [deg],pitch [deg],heading [deg]\n"
            "12.340000,1,-0.05,3.10,359.99\n"
            "1700000000.250000,3,-0.05,-90.00,359.99\n");
  EXPECT_EQ(table("baro"),
            "time [s],robot,pressure [Pa],temperature [degC]\n"
            "0.000006,1,1677721599.609375,42.49791667\n");
  EXPECT_EQ(table("heartbeat").substr(0, 47), "time [s],robot,state,link_alive,tilt,imu_silent");
  EXPECT_NE(
      table("heartbeat").find("\n0.000005,1,running,lost,1,0,0,0,0,0,0,0,0,0,0,0,1,0,0,0,0,0\n"),
      std::string::npos);
  EXPECT_EQ(err_.str(),
            scratch_.path().string() +
                "/radio.log: 4 messages of 4 lines; the clock of the log steps ahead by "
                "1699999988 s at line 2, or nothing was recorded for so long (and 1 "
                "more such steps)\n");
  EXPECT_NE(out_.str().find("attitude.csv\n"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(scratch_.path() / "radio_csv" / "power.csv"))
      << "no table without a message";
}

TEST_F(Decode, TheSlipOfTracksHasATableOfItsOwn) {
  std::string text;
  const auto say = [&](double time_s, const CanFrame& frame) {
    text += candump_line(static_cast<uint64_t>(std::llround(time_s * 1e6)), "can0", frame);
  };
  for (int i = 0; i <= 20; ++i) {
    const auto counter = static_cast<uint8_t>(i % 16);
    const auto count = static_cast<uint16_t>(i * 20);
    say(i * 0.05, protected_frame(message::Encoders{count, count, 0}, counter, 2));
    say(i * 0.05, protected_frame(message::Odometry{0, 0, 0}, counter, 2));
    if (i % 10 == 0) say(i * 0.05, protected_frame(message::Position{0, 0, 0, 102}, counter, 2));
  }
  EXPECT_EQ(csv(text), 0);
  EXPECT_EQ(table("track_slip"),
            "time [s],robot,slip_left [1],slip_right [1]\n"
            "0.500000,2,0.600,0.600\n"
            "1.000000,2,0.600,0.600\n");
  EXPECT_NE(out_.str().find("track_slip.csv\n"), std::string::npos);
  csv(attitude_line(0.1, 1, 0));
  EXPECT_EQ(out_.str().find("track_slip.csv\n"), std::string::npos) << "nothing is known of it";

  DecodeOptions options;
  options.log = log(text);
  options.csv = true;
  options.board = "abacus";
  EXPECT_THROW(run_decode(options, out_, err_), InputError);
}

TEST_F(Decode, NumbersInPlaceOfNames) {
  message::Heartbeat heartbeat{};
  heartbeat.state = 2;
  csv(candump_line(5, "can0", protected_frame(heartbeat, 0)), true);
  EXPECT_NE(table("heartbeat").find("\n0.000005,1,2,0,"), std::string::npos);
}

TEST_F(Decode, ManyRowsReachTheFileWhole) {
  std::string text;
  std::string wanted = "time [s],robot,roll [deg],pitch [deg],heading [deg]\n";
  for (int i = 0; i < 10000; ++i) {
    text += attitude_line(i, static_cast<int16_t>(i), static_cast<uint8_t>(i % 16));
    char row[80];
    std::snprintf(row, sizeof row, "%d.000000,1,-0.05,%d.%02d,359.99\n", i, i / 100, i % 100);
    wanted += row;
  }
  EXPECT_EQ(csv(text), 0);
  EXPECT_EQ(table("attitude"), wanted);
}

TEST_F(Decode, DamageIsSaidAndTheRestIsThere) {
  const std::string good = attitude_line(1, 1, 0);
  EXPECT_EQ(csv(good + std::string(5000, '\0') + "\n" + attitude_line(2, 2, 1) + "(000"), 1);
  const std::string rows = table("attitude");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3);
  EXPECT_NE(err_.str().find("2 messages of 4 lines, 2 unreadable (the first is line 2)"),
            std::string::npos)
      << err_.str();
}

/// The message of the InputError.
std::string refusal_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "nothing is refused";
}

TEST_F(Decode, WhatIsNoLogIsRefusedAndLeavesNothing) {
  const std::string others = candump_line(0, "can0", {0x777, 1, {1}});
  const std::pair<std::string, std::string> wrong[] = {
      {"what is this\n\x89HDF", ": is no candump log: 0 messages of 2 lines, 2 unreadable"},
      {others + "nonsense\n", ": holds no message that can be read: 0 messages of 2 lines"},
      {"", ": is empty"}};
  for (const auto& [text, said] : wrong) {
    const std::string path = log(text);
    for (const bool mcap : {false, true}) {
      DecodeOptions options;
      options.log = path;
      options.csv = !mcap;
      options.mcap = mcap;
      const std::string refusal = refusal_of([&] { run_decode(options, out_, err_); });
      EXPECT_EQ(refusal.rfind(path + said, 0), 0U) << refusal;
    }
    PlotOptions plot;
    plot.log = path;
    plot.signals = {"attitude.pitch"};
    const std::string refusal = refusal_of([&] { plot_chart(plot, err_); });
    EXPECT_EQ(refusal.rfind(path + said, 0), 0U) << refusal;
  }
  EXPECT_EQ(out_.str() + err_.str(), "") << "the refusal says all";
  for (const auto& entry : std::filesystem::directory_iterator(scratch_.path()))
    EXPECT_EQ(entry.path().filename(), "radio.log");
}

TEST_F(Decode, APlotThatEndsBeforeItBeginsIsRefused) {
  PlotOptions options;
  options.log = log(attitude_line(10, 100, 0));
  options.signals = {"attitude.pitch"};
  options.from_s = 10;
  options.to_s = 5;
  EXPECT_EQ(refusal_of([&] { plot_chart(options, err_); }), "--to 5: is before --from 10");
}

TEST_F(Decode, WrongInputIsSaid) {
  DecodeOptions options;
  options.log = "/nowhere/radio.log";
  options.out = scratch_.path().string();
  EXPECT_THROW(run_decode(options, out_, err_), InputError) << "neither CSV nor MCAP";
  options.csv = true;
  EXPECT_THROW(run_decode(options, out_, err_), InputError);
  options.log = log(attitude_line(1, 1, 0));
  options.out = "/proc/nowhere";
  EXPECT_THROW(run_decode(options, out_, err_), RunError);
}

/// Records of an MCAP file, by its specification: kind and content.
std::vector<std::pair<int, std::string>> records_of(std::string bytes) {
  std::vector<std::pair<int, std::string>> records;
  while (bytes.size() > 9) {
    uint64_t size = 0;
    std::memcpy(&size, bytes.data() + 1, 8);
    EXPECT_LE(size + 9, bytes.size());
    if (size + 9 > bytes.size()) break;
    records.emplace_back(static_cast<unsigned char>(bytes[0]), bytes.substr(9, size));
    bytes.erase(0, 9 + size);
  }
  EXPECT_TRUE(bytes.empty());
  return records;
}

template <typename Number>
Number number_at(const std::string& bytes, size_t at) {
  Number number{};
  EXPECT_LE(at + sizeof number, bytes.size());
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

/// The records in a chunk.
std::string content_of_chunk(const std::string& chunk) {
  constexpr size_t kPrefix = 44;  // times, size, checksum, "zstd", packed size
  EXPECT_EQ(chunk.substr(32, 4), "zstd");
  std::string content(number_at<uint64_t>(chunk, 16), '\0');
  EXPECT_EQ(ZSTD_decompress(content.data(), content.size(), chunk.data() + kPrefix,
                            chunk.size() - kPrefix),
            content.size());
  return content;
}

TEST_F(Decode, McapHoldsTheMessagesAndItsOwnIndex) {
  DecodeOptions options;
  options.log =
      log(attitude_line(1, 310, 0) + attitude_line(2, -310, 1) + attitude_line(3, 0, 0, 2));
  options.mcap = true;
  EXPECT_EQ(run_decode(options, out_, err_), 0);
  const std::string bytes = read_file(scratch_.path() / "radio.mcap");
  const std::string magic("\x89MCAP0\r\n", 8);
  ASSERT_EQ(bytes.substr(0, 8), magic);
  ASSERT_EQ(bytes.substr(bytes.size() - 8), magic);
  const auto records = records_of(bytes.substr(8, bytes.size() - 16));
  std::vector<int> kinds;
  kinds.reserve(records.size());
  for (const auto& [kind, content] : records) kinds.push_back(kind);
  // Header, chunk with two indices, end of data; schema, two channels, statistics, index of the
  // chunk; offsets of these four groups; footer.
  EXPECT_EQ(kinds, (std::vector<int>{1, 6, 7, 7, 15, 3, 4, 4, 11, 8, 14, 14, 14, 14, 2}));

  const std::string messages = content_of_chunk(records[1].second);
  const auto inner = records_of(messages);
  ASSERT_EQ(inner.size(), 6U);
  EXPECT_EQ(inner[0].first, 3);
  const std::string& schema = inner[0].second;
  const Json json = Json::parse(schema.substr(schema.find('{')));
  EXPECT_EQ(json["properties"]["pitch"]["type"], "number");
  EXPECT_EQ(json["properties"]["pitch"]["description"], "deg; nose up is positive");
  EXPECT_NE(inner[1].second.find("/robot1/attitude"), std::string::npos);
  EXPECT_EQ(inner[2].second.substr(22), R"({"roll":-0.05,"pitch":3.10,"heading":359.99})");
  EXPECT_EQ(number_at<uint64_t>(inner[3].second, 6), 2000000000U);
  EXPECT_EQ(inner[3].second.substr(22), R"({"roll":-0.05,"pitch":-3.10,"heading":359.99})");

  // Each index entry leads to its message.
  const std::string& index = records[2].second;
  EXPECT_EQ(number_at<uint64_t>(index, 6), 1000000000U);
  const auto place = number_at<uint64_t>(index, 14);
  EXPECT_EQ(messages[place], 5);
  // The footer leads to the summary.
  const auto summary = number_at<uint64_t>(records.back().second, 0);
  EXPECT_EQ(bytes[summary], 3);
  EXPECT_EQ(number_at<uint64_t>(records[8].second, 0), 3U) << "messages";
}

TEST_F(Decode, PlotsSignalsOfEachRobot) {
  PlotOptions options;
  options.log = log(attitude_line(10, 100, 0) + attitude_line(11, 200, 1) +
                    attitude_line(11.5, 300, 0, 2) + attitude_line(12, 400, 2));
  options.signals = {"attitude.pitch", "attitude.roll"};
  StackedChart chart = plot_chart(options, err_);
  ASSERT_EQ(chart.panels.size(), 1U);
  ASSERT_EQ(chart.panels[0].series.size(), 4U);
  EXPECT_EQ(chart.panels[0].title, "[deg]");
  const ChartSeries& first = chart.panels[0].series[0];
  EXPECT_EQ(first.label, "attitude.pitch, robot 1");
  ASSERT_EQ(first.points.size(), 3U);
  EXPECT_DOUBLE_EQ(first.points[2].x, 2.0);
  EXPECT_DOUBLE_EQ(first.points[2].y, 4.0);
  options.robot = 1;
  options.from_s = 0.5;
  options.to_s = 1.5;
  chart = plot_chart(options, err_);
  ASSERT_EQ(chart.panels[0].series.size(), 2U);
  EXPECT_EQ(chart.panels[0].series[0].label, "attitude.pitch");
  EXPECT_EQ(chart.panels[0].series[0].points.size(), 1U);
  EXPECT_EQ(err_.str(), "");
  options.signals = {"power.battery"};
  EXPECT_THROW(plot_chart(options, err_), InputError) << "not in the log";
}

TEST_F(Decode, PlotsShowAllOfALogWhoseClockIsSet) {
  PlotOptions options;
  options.log = log(attitude_line(2000, 100, 0) + attitude_line(2001, 200, 1) +
                    attitude_line(1001, 300, 2) + attitude_line(1001.5, 400, 3));
  options.signals = {"attitude.pitch"};
  const StackedChart chart = plot_chart(options, err_);
  const std::vector<ChartPoint>& points = chart.panels[0].series[0].points;
  ASSERT_EQ(points.size(), 4U);
  EXPECT_DOUBLE_EQ(points[2].x, 1.0);
  EXPECT_DOUBLE_EQ(points[3].x, 1.5);
  EXPECT_NE(err_.str().find("the clock of the log steps back by 1000 s at line 3\n"),
            std::string::npos)
      << err_.str();
}

TEST_F(Decode, FramesWithoutATimeAreNamed) {
  std::string error = "no error";
  try {
    csv("  can0  210   [2]  2A 36\n");
  } catch (const InputError& it) {
    error = it.what();
  }
  EXPECT_NE(error.find("1 without a time (candump -L writes it)"), std::string::npos) << error;
}

std::string heartbeat_line(double time_s, uint8_t state, uint16_t faults, uint8_t counter) {
  message::Heartbeat heartbeat{};
  heartbeat.state = state;
  heartbeat.faults = faults;
  return candump_line(static_cast<uint64_t>(std::llround(time_s * 1e6)), "can0",
                      protected_frame(heartbeat, counter));
}

TEST_F(Decode, PlotsStatesAndFlagsAsBands) {
  PlotOptions options;
  options.log = log(attitude_line(10, 100, 0) + heartbeat_line(10, 0, 0, 0) +
                    heartbeat_line(10.2, 2, 0, 1) + heartbeat_line(10.4, 2, 5, 2) +
                    heartbeat_line(10.6, 4, 5, 3) + attitude_line(11, 200, 1));
  options.signals = {"heartbeat.state", "attitude.pitch", "heartbeat.faults", "heartbeat.tilt",
                     "heartbeat.stuck"};
  const StackedChart chart = plot_chart(options, err_);
  ASSERT_EQ(chart.panels.size(), 2U);
  EXPECT_EQ(chart.panels[0].title, "attitude.pitch [deg]");
  EXPECT_TRUE(chart.panels[0].rows.empty());
  const std::vector<BandRow>& rows = chart.panels[1].rows;
  ASSERT_EQ(rows.size(), 4U);
  EXPECT_EQ(rows[0].label, "heartbeat.state");
  ASSERT_EQ(rows[0].bands.size(), 3U);
  EXPECT_EQ(rows[0].bands[0].name, "disarmed");
  EXPECT_EQ(rows[0].bands[1].name, "running");
  EXPECT_DOUBLE_EQ(rows[0].bands[1].begin, 0.2);
  EXPECT_DOUBLE_EQ(rows[0].bands[1].end, 0.6);
  EXPECT_EQ(rows[0].bands[2].name, "fault");
  EXPECT_DOUBLE_EQ(rows[0].bands[2].end, 0.8) << "a period of 5 Hz after the last";
  // A flag that is clear has no band; a field of flags names those that are set.
  ASSERT_EQ(rows[1].bands.size(), 1U);
  EXPECT_EQ(rows[1].bands[0].name, "tilt, gyro_frozen");
  EXPECT_DOUBLE_EQ(rows[1].bands[0].begin, 0.4);
  ASSERT_EQ(rows[2].bands.size(), 1U);
  EXPECT_DOUBLE_EQ(rows[2].bands[0].begin, 0.4);
  EXPECT_TRUE(rows[3].bands.empty());
  EXPECT_EQ(err_.str(), "");
  options.signals = {"heartbeat.stuck"};
  EXPECT_NE(stacked_chart_svg(plot_chart(options, err_)).find(">heartbeat.stuck<"),
            std::string::npos);
}

TEST_F(Decode, PlotsEndWithTheLog) {
  PlotOptions options;
  options.log = log(heartbeat_line(10, 2, 5, 0) + heartbeat_line(10.2, 2, 5, 1) +
                    attitude_line(10.25, 100, 0));
  options.signals = {"heartbeat.state", "heartbeat.tilt"};
  const StackedChart chart = plot_chart(options, err_);
  for (const BandRow& row : chart.panels[0].rows) {
    ASSERT_EQ(row.bands.size(), 1U);
    EXPECT_DOUBLE_EQ(row.bands[0].end, 0.25) << "not a period of 0.2 s after the last heartbeat";
  }
}

TEST_F(Decode, PlotsOfHeadingsBreakWhereTheyWrap) {
  PlotOptions options;
  options.log = log(attitude_line(10, 100, 0) + attitude_line(11, 200, 1));
  options.signals = {"attitude.heading", "attitude.pitch"};
  const ChartPanel panel = plot_chart(options, err_).panels.at(0);
  EXPECT_EQ(panel.series[0].jump, 180.0);
  EXPECT_EQ(panel.series[1].jump, 0.0);
}

TEST_F(Decode, PlotsNameWhatTheLogLacks) {
  PlotOptions options;
  options.log = log(heartbeat_line(10, 2, 0, 0) + heartbeat_line(10.2, 2, 0, 1));
  options.signals = {"heartbeat.tilt", "power.battery", "leveling.state"};
  EXPECT_EQ(plot_chart(options, err_).panels.size(), 1U);
  EXPECT_NE(err_.str().find("holds no message with power.battery, leveling.state"),
            std::string::npos)
      << err_.str();
}

TEST_F(Decode, ABandBridgesLossesOfASecond) {
  const PlotSignal signal("leveling.state");  // 10 times a second
  EXPECT_EQ(band_row(signal, "", {{0.0, 1}, {0.9, 1}}, 5.0).bands.size(), 1U);
  EXPECT_EQ(band_row(signal, "", {{0.0, 1}, {1.1, 1}}, 5.0).bands.size(), 2U);
}

TEST_F(Decode, PlotsKeepThePeaksOfManyPoints) {
  std::string text;
  for (int i = 0; i < 20000; ++i) {
    text += attitude_line(i * 0.04, i == 12345 ? int16_t{9000} : int16_t{0},
                          static_cast<uint8_t>(i % 16));
  }
  PlotOptions options;
  options.log = log(text);
  options.signals = {"attitude.pitch"};
  const StackedChart chart = plot_chart(options, err_);
  const std::vector<ChartPoint>& points = chart.panels[0].series[0].points;
  EXPECT_LE(points.size(), 2000U);
  double most = 0.0;
  for (const ChartPoint& point : points) most = std::max(most, point.y);
  EXPECT_DOUBLE_EQ(most, 90.0);
}

TEST_F(Decode, PlotsBecomeSvgOrPng) {
  PlotOptions options;
  options.log = log(attitude_line(10, 100, 0) + attitude_line(11, 200, 1));
  options.signals = {"attitude.pitch"};
  options.out = (scratch_.path() / "it.svg").string();
  EXPECT_EQ(run_plot(options, err_), 0);
  EXPECT_EQ(read_file(options.out).substr(0, 4), "<svg");
  options.out = (scratch_.path() / "it.png").string();
  EXPECT_EQ(run_plot(options, err_), 0);
  const std::string png = read_file(options.out);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(number_at<uint32_t>(png, 16), 0x80070000U) << "1920 pixels wide";
  options.out = (scratch_.path() / "it.gif").string();
  EXPECT_THROW(run_plot(options, err_), InputError);
}

}  // namespace
}  // namespace screed
