// The downlink: its rates, its load, and what its frames say, read back by id.
#include "firmware/robot/telemetry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "firmware/protocol/e2e.h"
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

class TelemetryTest : public ::testing::Test {
 protected:
  TelemetryTest() {
    view_.sample = &sample_;
    view_.robot = &robot_;
    view_.uplink = &uplink_;
  }

  /// Runs ticks, with an acknowledgement to send every so many of them (0: never).
  Downlink run(int ticks, int ack_period = 0) {
    Downlink downlink;
    SlcanParser parser;
    for (int tick = 0; tick < ticks; ++tick) {
      if (ack_period != 0 && tick % ack_period == 0) acknowledge(RequestResult::kNotReady);
      RobotOutput output{};
      telemetry_.tick(view_, output);
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
  /// The payload of the first frame of an id.
  const uint8_t* payload(uint16_t id) {
    downlink_ = run(100);
    EXPECT_EQ(downlink_.frames.count(id), 1U);
    return downlink_.frames[id].front().data + kE2eHeaderSize;
  }
  const CanFrame& downlink_of(uint16_t id) {
    payload(id);
    return downlink_.frames[id].front();
  }
  uint8_t header_bits(uint16_t id) {
    downlink_ = run(100);
    return static_cast<uint8_t>(downlink_.frames[id].front().data[1] >> 4);
  }

  SensorSample sample_{};
  RobotStatus robot_{};
  UplinkCounts uplink_{};
  TelemetryView view_{};
  Telemetry telemetry_{1};
  Downlink downlink_;
};

/// Messages a second as the schema wants them, by id.
std::map<uint16_t, size_t> rates() {
  std::map<uint16_t, size_t> all;
  for (const schema::DbcMessage& message :
       schema::read_dbc("firmware/protocol/screed.dbc").messages) {
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
    RobotOutput output{};
    telemetry_.tick(view_, output);
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

TEST_F(TelemetryTest, Heartbeat) {
  robot_.state = RobotState::kStopped;
  view_.faults = 0x1234;
  view_.link_alive = true;
  view_.boot_epoch = 0x5678;
  view_.freshness = 0x9ABC;
  downlink_ = run(100);
  auto heartbeat = message::Heartbeat::unpack(downlink_.frames[kIdHeartbeat].front().data);
  EXPECT_EQ(heartbeat.state, 3);
  EXPECT_EQ(heartbeat.faults, 0x1234);
  EXPECT_EQ(heartbeat.link_alive, 1);
  EXPECT_EQ(heartbeat.boot_epoch, 0x5678);
  EXPECT_EQ(heartbeat.freshness, 0x9ABC);
  view_.link_alive = false;
  downlink_ = run(100);
  heartbeat = message::Heartbeat::unpack(downlink_.frames[kIdHeartbeat].front().data);
  EXPECT_EQ(heartbeat.link_alive, 0);
  EXPECT_EQ(heartbeat.state, 3);
}

TEST_F(TelemetryTest, LinkAndTime) {
  uplink_.frames_received = 1000;
  view_.rejected_lines = 200;
  uplink_.rejected_frames = 201;
  view_.rejected_commands = 202;
  uplink_.ground_time_ms = 4321;
  for (const int heard : {5, 4, 3, 0, 6, 9}) {  // heartbeats since the last message
    uplink_.ground_heartbeats = static_cast<uint8_t>(uplink_.ground_heartbeats + heard);
    downlink_ = run(100);
    const auto link = message::Link::unpack(downlink_.frames[kIdLink].front().data);
    EXPECT_EQ(link.quality, std::min(100, 20 * heard));
    EXPECT_EQ(link.frames_received, 1000);
    EXPECT_EQ(link.lines_rejected, 200);
    EXPECT_EQ(link.frames_rejected, 201);
    EXPECT_EQ(link.commands_rejected, 202);
  }
  sample_.time_us = 4000000123U;
  downlink_ = run(100);
  const auto time = message::Time::unpack(downlink_.frames[kIdTime].front().data);
  EXPECT_EQ(time.time, 4000000U);
  EXPECT_EQ(time.echo, 4321);
}

// The sample's time wraps after 71.6 minutes; the ground's clocks do not.
TEST_F(TelemetryTest, TimeGoesOnWhenTheSamplesTimeWraps) {
  std::uint32_t last_ms = 0;
  for (int second = 0; second < 2 * 4295; ++second) {
    sample_.time_us += 1000000U;
    downlink_ = run(100);
    const auto time = message::Time::unpack(downlink_.frames[kIdTime].front().data);
    if (second > 0) {
      ASSERT_EQ(time.time - last_ms, 1000U) << second;
    }
    last_ms = time.time;
  }
}

TEST_F(TelemetryTest, TheLongestTickIsThatSinceTheLastMessage) {
  run(100);
  sample_.last_tick_us = 5000;
  run(1);
  sample_.last_tick_us = 100;
  const Downlink downlink = run(199);
  const std::vector<CanFrame>& frames = downlink.frames.at(kIdHealth);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(message::Health::unpack(frames[0].data).longest_tick, 5000);
  EXPECT_EQ(message::Health::unpack(frames[1].data).longest_tick, 100);
}

TEST_F(TelemetryTest, HealthOfTheParts) {
  using Conditions = message::HealthConditions;
  sample_.reset_cause = static_cast<uint8_t>(message::HealthResetCause::kWatchdog);
  sample_.bus_errors = 200;
  sample_.radio_errors = 201;
  sample_.chips_failing = Conditions::kGyroChip | Conditions::kBaroChip;
  view_.starting = true;
  auto health = message::Health::unpack(downlink_of(kIdHealth).data);
  EXPECT_EQ(health.reset_cause, 2);
  EXPECT_EQ(health.i2c_errors, 200);
  EXPECT_EQ(health.uart_errors, 201);
  EXPECT_EQ(health.conditions,
            Conditions::kGyroChip | Conditions::kBaroChip | Conditions::kStarting);
  EXPECT_EQ(health.longest_tick, 0);
  sample_.chips_failing = 0;
  view_.starting = false;
  view_.mag_disturbed = true;
  health = message::Health::unpack(downlink_of(kIdHealth).data);
  EXPECT_EQ(health.conditions, Conditions::kMagDisturbed);
  EXPECT_EQ(health.longest_tick, 0) << "still nothing took a time";
}

TEST_F(TelemetryTest, AttitudeAndOdometry) {
  robot_.angles = {INT16_MIN, 8192, -1, 0, 0};  // 65536 a turn
  robot_.place = {{-32767, 32767}, {0, 0}};
  const uint8_t* at = payload(kIdAttitude);
  EXPECT_EQ(get_s16(at), -18000);
  EXPECT_EQ(get_s16(at + 2), 4500);
  EXPECT_EQ(get_u16(at + 4), 35999);
  at = payload(kIdOdometry);
  EXPECT_EQ(get_s16(at), -32767);
  EXPECT_EQ(get_s16(at + 2), 32767);
  EXPECT_EQ(get_u16(at + 4), 35999);
}

TEST_F(TelemetryTest, Leveling) {
  view_.algorithm = LevelingAlgorithm::kSpinOnPeak;
  view_.leveling_state = LevelingState::kSpin;
  view_.peaks = 258;
  robot_.motion = {-123, 16384};  // 90 degrees/s
  const uint8_t* at = payload(kIdLeveling);
  EXPECT_EQ(at[0], 2);
  EXPECT_EQ(at[1], 2);  // the lower byte of 258
  EXPECT_EQ(get_s16(at + 2), -123);
  EXPECT_EQ(get_s16(at + 4), 9000);
  EXPECT_EQ(header_bits(kIdLeveling), 3);
  view_.peaks = 0x2FF;
  EXPECT_EQ(payload(kIdLeveling)[1], 0xFF);
}

TEST_F(TelemetryTest, EncodersAndMotors) {
  sample_.encoder_left = 65535;
  sample_.encoder_right = 1;
  sample_.encoder_errors = 77;
  robot_.duty.duty_left = -400;
  robot_.duty.duty_right = 400;
  const uint8_t* at = payload(kIdEncoders);
  EXPECT_EQ(get_u16(at), 65535);
  EXPECT_EQ(get_u16(at + 2), 1);
  EXPECT_EQ(get_u16(at + 4) * 4, 10000);
  at = payload(kIdMotors);
  EXPECT_EQ(get_s16(at), -400);
  EXPECT_EQ(get_s16(at + 2), 400);
  EXPECT_EQ(at[4], 77);
  EXPECT_EQ(header_bits(kIdMotors), 0);
}

TEST_F(TelemetryTest, SlipAndStuckTravelWithTheMotors) {
  view_.slip = 1;
  EXPECT_EQ(header_bits(kIdMotors), 1);
  view_.stuck = 1;
  EXPECT_EQ(header_bits(kIdMotors), 3);
}

TEST_F(TelemetryTest, RawVectors) {
  for (int16_t i = 0; i < 3; ++i) {
    sample_.accel[i] = static_cast<int16_t>(-4098 + i);
    sample_.gyro[i] = static_cast<int16_t>(100 + i);
    sample_.mag[i] = static_cast<int16_t>(INT16_MIN + i);
  }
  const uint8_t* accel = payload(kIdAccelRaw);
  EXPECT_EQ(get_s16(accel + 4), -4096);
  const uint8_t* gyro = payload(kIdGyroRaw);
  EXPECT_EQ(get_s16(gyro + 2), 101);
  const uint8_t* mag = payload(kIdMagRaw);
  EXPECT_EQ(get_s16(mag), INT16_MIN);
}

TEST_F(TelemetryTest, PowerAndLoad) {
  robot_.battery_mv = 7312;
  sample_.last_tick_us = 4321;
  const uint8_t* at = payload(kIdPower);
  EXPECT_EQ(get_u16(at), 7312);
  EXPECT_EQ(at[2], 43);
  // Per cent of a tick, rounded down; 255 stands for all above as well.
  const std::map<uint16_t, int> loads = {{99, 0},      {100, 1},     {25499, 254},
                                         {25500, 255}, {25600, 255}, {UINT16_MAX, 255}};
  for (const auto& [time_us, load] : loads) {
    sample_.last_tick_us = time_us;
    EXPECT_EQ(payload(kIdPower)[2], load) << time_us;
  }
}

// As the sensor says it: temperature 42.5 degC + raw / 480, pressure without its last four bits,
// 256 a hPa, less than its noise.
TEST_F(TelemetryTest, BaroKeepsTheSensorsResolution) {
  sample_.pressure = static_cast<int32_t>(1013.25 * 4096);
  sample_.temperature = -10800;
  const message::Baro it = message::Baro::unpack(downlink_of(kIdBaro).data);
  EXPECT_EQ(it.pressure * 0.390625, 101325.0);
  EXPECT_EQ(it.temperature, -10800);
  sample_.pressure += 41;  // 0.01 hPa, the sensor's noise
  EXPECT_GE(message::Baro::unpack(downlink_of(kIdBaro).data).pressure, it.pressure + 2);
  sample_.pressure = INT32_MIN;  // not a value of 24 bits: nonsense, but no overflow
  downlink_of(kIdBaro);
}

}  // namespace
}  // namespace screed
