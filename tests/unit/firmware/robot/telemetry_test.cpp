// The downlink: its rates and its load. What its frames say is in robot_downlink_test.cpp.
#include "firmware/robot/telemetry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "firmware/protocol/e2e.h"
#include "firmware/robot/supervisor.h"
#include "tools/schema/dbc.h"

namespace screed {
namespace {

struct Downlink {
  std::map<uint16_t, std::vector<CanFrame>> frames;
  std::map<uint16_t, std::vector<int>> ticks;  ///< in which they were sent
  std::vector<uint16_t> order;                 ///< ids
  int bytes = 0;
  int most_in_a_tick = 0;
};

const std::vector<schema::DbcMessage>& messages() {
  static const schema::Database database = schema::read_dbc("firmware/protocol/screed.dbc");
  return database.messages;
}

uint8_t size_of(uint16_t id) {
  for (const schema::DbcMessage& message : messages())
    if (message.id == id) return static_cast<uint8_t>(message.size);
  ADD_FAILURE() << "no message " << id;
  return 0;
}

class TelemetryTest : public ::testing::Test {
 protected:
  /// Runs ticks, with an acknowledgement to send every so many of them (0: never).
  Downlink run(int ticks, int ack_period = 0) {
    Downlink downlink;
    SlcanParser parser;
    for (int tick = 0; tick < ticks; ++tick) {
      if (ack_period != 0 && tick % ack_period == 0) acknowledge(RequestResult::kNotReady);
      const RobotOutput output = this->tick();
      EXPECT_LE(output.radio_out_count, kRadioOutCapacity);
      if (output.radio_out_count > 0) {
        EXPECT_EQ(output.radio_out[output.radio_out_count - 1], '\r')
            << "not whole lines in tick " << tick;
      }
      downlink.bytes += output.radio_out_count;
      downlink.most_in_a_tick = std::max<int>(downlink.most_in_a_tick, output.radio_out_count);
      CanFrame frame{};
      for (uint8_t i = 0; i < output.radio_out_count; ++i) {
        if (!parser.feed(output.radio_out[i], frame)) continue;
        EXPECT_TRUE(e2e_check(frame.id, frame.data, frame.size));
        downlink.frames[frame.id].push_back(frame);
        downlink.ticks[frame.id].push_back(tick);
        downlink.order.push_back(frame.id);
      }
    }
    EXPECT_EQ(parser.rejected(), 0);
    return downlink;
  }
  void acknowledge(RequestResult result, uint8_t freshness = 7) {
    telemetry_.queue(frame_of(message::CommandAck{static_cast<uint8_t>(CommandOp::kArm), freshness,
                                                  static_cast<uint8_t>(result), 0x1234}));
  }
  /// One tick, with empty frames.
  RobotOutput tick() {
    RobotOutput output{};
    telemetry_.begin_tick(output);
    for (uint8_t message = 0; message < kTelemetryMessages; ++message) {
      if (!telemetry_.due(message, output)) continue;
      CanFrame frame{};
      frame.id = Telemetry::id(message);
      frame.size = size_of(frame.id);
      telemetry_.send(frame, message, output);
    }
    return output;
  }

  Telemetry telemetry_{1};
};

/// Messages a second as the schema wants them, by id.
std::map<uint16_t, size_t> rates() {
  std::map<uint16_t, size_t> all;
  for (const schema::DbcMessage& message : messages()) {
    if (message.from_ground() || message.period_ms() == 0) continue;
    EXPECT_EQ(1000 % message.period_ms(), 0) << message.name;
    all[static_cast<uint16_t>(message.id)] = static_cast<size_t>(1000 / message.period_ms());
  }
  return all;
}

TEST_F(TelemetryTest, RatesAreExactlyTheSchedulesAndTheLoadIsBelowHalf) {
  run(1);
  const Downlink downlink = run(1000);
  EXPECT_EQ(rates().size(), kTelemetryMessages);
  EXPECT_EQ(downlink.frames.size(), rates().size());
  for (const auto& [id, rate] : rates())
    EXPECT_EQ(downlink.frames.at(id).size(), rate * 10) << std::hex << id;
  EXPECT_LE(downlink.bytes, 5760 * 10 / 2);
}

// Spread over the first 65 ticks; packets go in every second tick, so what is due in an odd one
// goes in the next.
TEST_F(TelemetryTest, EachMessageStartsInItsOwnTickAndKeepsItsPeriod) {
  const std::map<uint16_t, int> first_due = {
      {kIdHeartbeat, 0}, {kIdAttitude, 1}, {kIdEncoders, 2}, {kIdMotors, 3}, {kIdLeveling, 4},
      {kIdOdometry, 6},  {kIdAccelRaw, 8}, {kIdGyroRaw, 9},  {kIdPower, 14}, {kIdMagRaw, 24},
      {kIdBaro, 34},     {kIdHealth, 44},  {kIdLink, 54},    {kIdTime, 64},  {kIdPosition, 19},
  };
  const Downlink downlink = run(300);
  ASSERT_EQ(downlink.ticks.size(), first_due.size());
  for (const auto& [id, rate] : rates()) {
    const std::vector<int>& ticks = downlink.ticks.at(id);
    for (size_t i = 0; i < ticks.size(); ++i) {
      const int due = first_due.at(id) + static_cast<int>(i * 100 / rate);
      EXPECT_EQ(ticks[i], due + due % 2) << std::hex << id;
    }
  }
}

TEST_F(TelemetryTest, APacketHasTheImportantFirst) {
  run(8);
  const Downlink downlink = run(1);
  EXPECT_EQ(downlink.order, (std::vector<uint16_t>{kIdEncoders, kIdMotors, kIdAccelRaw}));
}

TEST_F(TelemetryTest, AliveCountersStartAtZero) {
  acknowledge(RequestResult::kDone);
  telemetry_.queue(frame_of(message::ParamValue{}));
  telemetry_.queue(frame_of(message::Event{}));
  const Downlink downlink = run(100);
  EXPECT_EQ(downlink.frames.size(), kTelemetryMessages + 3U);
  for (const auto& [id, frames] : downlink.frames) {
    EXPECT_EQ(frames.front().data[1] & 0x0F, 0) << std::hex << id;
  }
}

TEST_F(TelemetryTest, AnswersDelayButDoNotDisplace) {
  run(3);
  const Downlink downlink = run(10000, 10);
  for (const auto& [id, rate] : rates()) {
    const size_t sent = downlink.frames.at(id).size();
    EXPECT_GE(sent, rate * 100 - 1) << std::hex << id;
    EXPECT_LE(sent, rate * 100 + 1) << std::hex << id;
  }
  EXPECT_EQ(downlink.frames.at(kIdCommandAck).size(), 1000U);
  EXPECT_LE(downlink.bytes, 5760 * 100 / 2);
}

TEST_F(TelemetryTest, MoreThanTheBudgetIsNeverSentAndTheImportantComesFirst) {
  const Downlink downlink = run(10000, 1);
  EXPECT_LE(downlink.bytes, 5760 * 100 / 2 + 100);
  EXPECT_EQ(downlink.frames.at(kIdHeartbeat).size(), 500U);
  EXPECT_GE(downlink.frames.at(kIdCommandAck).size(), 5000U);
}

TEST_F(TelemetryTest, PacketsAreWholeLinesAtMostFourAndThenTheLineIsIdle) {
  int since = 100;
  int most = 0;
  for (int tick = 0; tick < 2000; ++tick) {
    if (tick % 5 == 0) acknowledge(RequestResult::kDone);
    const bool due = telemetry_.is_packet_tick();
    const RobotOutput output = this->tick();
    const auto lines =
        std::count(output.radio_out, output.radio_out + output.radio_out_count, '\r');
    EXPECT_LE(lines, 4);
    most = std::max(most, static_cast<int>(lines));
    // 88 characters take 15.3 ms.
    EXPECT_TRUE(output.radio_out_count == 0 || since >= 2) << tick;
    EXPECT_TRUE(output.radio_out_count == 0 || due) << tick;
    since = output.radio_out_count == 0 ? since + 1 : 1;
  }
  EXPECT_EQ(most, 4);
}

TEST_F(TelemetryTest, APacketHoldsFourOfTheLongestLines) {
  run(1000);  // leaves budget
  for (int i = 0; i < 4; ++i) telemetry_.queue(frame_of(message::Event{}));
  const Downlink downlink = run(2);
  EXPECT_EQ(downlink.bytes, 4 * kSlcanLineMax);
  EXPECT_EQ(downlink.order, std::vector<uint16_t>(4, kIdEvent));
}

// The line that takes the last of the budget goes, one for which a byte is missing waits.
TEST_F(TelemetryTest, WhatWaitsIsSentAsLongAsTheBudgetHasALine) {
  int budget = 0;
  bool to_the_last = false;
  for (int tick = 0; tick < 200; ++tick) {
    for (int i = 0; i < 4; ++i) acknowledge(RequestResult::kDone);  // there is always one waiting
    if (!telemetry_.is_packet_tick()) {
      EXPECT_EQ(run(1).bytes, 0);
      continue;
    }
    budget += Telemetry::kPacketBudget;
    const Downlink downlink = run(1);
    for (const uint16_t id : downlink.order) {
      EXPECT_GE(budget, kSlcanLineMax) << tick;
      to_the_last = to_the_last || budget == kSlcanLineMax;
      budget -= 6 + 2 * downlink.frames.at(id).front().size;
    }
    EXPECT_TRUE(budget < kSlcanLineMax || downlink.order.size() == 4) << tick;
  }
  EXPECT_TRUE(to_the_last);
}

TEST_F(TelemetryTest, CountersRiseByOne) {
  const Downlink downlink = run(1000, 50);
  for (const auto& [id, frames] : downlink.frames) {
    for (size_t i = 1; i < frames.size(); ++i) {
      ASSERT_EQ(frames[i].data[1] & 0x0F, (frames[i - 1].data[1] + 1) & 0x0F) << std::hex << id;
    }
  }
}

TEST_F(TelemetryTest, AnAcknowledgementIsSentOnceInTheNextTick) {
  acknowledge(RequestResult::kFaultPresent);
  const Downlink first = run(1);
  ASSERT_EQ(first.frames.count(kIdCommandAck), 1U);
  const CanFrame& frame = first.frames.at(kIdCommandAck).front();
  EXPECT_EQ(frame.size, message::CommandAck::kSize);
  const auto ack = message::CommandAck::unpack(frame.data);
  EXPECT_EQ(ack.op, static_cast<uint8_t>(message::CommandAckOp::kArm));
  EXPECT_EQ(ack.freshness, 7);
  EXPECT_EQ(ack.result, static_cast<uint8_t>(message::CommandAckResult::kFaultPresent));
  EXPECT_EQ(ack.detail, 0x1234);
  EXPECT_EQ(run(100).frames.count(kIdCommandAck), 0U);
}

TEST_F(TelemetryTest, FourAnswersWaitAtMostAndLaterOnesAreDropped) {
  for (uint8_t i = 1; i <= 6; ++i) acknowledge(RequestResult::kDone, i);
  const Downlink downlink = run(20);
  const std::vector<CanFrame>& acks = downlink.frames.at(kIdCommandAck);
  ASSERT_EQ(acks.size(), 4U);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(message::CommandAck::unpack(acks[i].data).freshness, i + 1);
  }
  acknowledge(RequestResult::kDone, 9);
  const Downlink later = run(4);
  ASSERT_EQ(later.frames.count(kIdCommandAck), 1U);
  EXPECT_EQ(message::CommandAck::unpack(later.frames.at(kIdCommandAck).front().data).freshness, 9);
}

}  // namespace
}  // namespace screed
