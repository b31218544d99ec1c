// The schema's two products against each other and against the firmware: the structures that the
// robot packs, the tables that the host reads.
#include "host_sim/ground_station/telemetry/schema.h"

#include <gtest/gtest.h>

#include <set>

#include "firmware/leveling/leveling.h"
#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "firmware/robot/supervisor.h"
#include "hal/avr/reset_cause.h"
#include "hal/sample.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/random.h"
#include "tools/schema/dbc.h"
#include "tools/schema/schema_check.h"

namespace screed {
namespace {

/// The raw value of a signal of a packed message.
int64_t raw_of(const CanFrame& frame, const char* path) {
  return find_signal(path).signal->raw(frame.data);
}

TEST(Schema, TablesReadWhatTheStructuresWrite) {
  const message::Attitude attitude = {-18000, 8999, 35999};
  CanFrame frame = frame_of(attitude);
  e2e_protect(frame.id, 9, frame.data, frame.size);
  EXPECT_EQ(raw_of(frame, "attitude.roll"), -18000);
  EXPECT_EQ(raw_of(frame, "attitude.pitch"), 8999);
  EXPECT_EQ(raw_of(frame, "attitude.heading"), 35999);
  EXPECT_EQ(raw_of(frame, "attitude.counter"), 9);
  EXPECT_EQ(raw_of(frame, "attitude.crc"), frame.data[0]);

  const message::Command command = {6, 0xABCDEF, 0x12, 0x345678};
  frame = frame_of(command);
  EXPECT_EQ(raw_of(frame, "command.argument"), 0xABCDEF);
  EXPECT_EQ(raw_of(frame, "command.mac"), 0x345678);
  EXPECT_EQ(frame.data[1], 0xEF);
  EXPECT_EQ(frame.data[7], 0x34);

  const message::Event event = {7, INT32_MIN};
  EXPECT_EQ(raw_of(frame_of(event), "event.argument"), INT32_MIN);
}

// Whatever stands in the 64 bits: unpack() and pack() give it back, and tables and structures
// agree.
template <typename Message>
void round_trip(const char* name) {
  const MessageInfo* const info = find_message(static_cast<uint16_t>(Message::kId));
  ASSERT_NE(info, nullptr);
  EXPECT_STREQ(info->title, name);
  EXPECT_EQ(info->size, Message::kSize);
  WorldRandom random(7, name);
  for (int i = 0; i < 2000; ++i) {
    CanFrame frame{Message::kId, Message::kSize, {}};
    for (uint8_t& byte : frame.data) {
      const double kind = random.uniform();  // edges often
      byte = kind < 0.2   ? 0
             : kind < 0.4 ? 0xFF
             : kind < 0.5 ? 0x80
                          : static_cast<uint8_t>(random.uniform() * 256.0);
    }
    CanFrame again{Message::kId, Message::kSize, {}};
    Message::unpack(frame.data).pack(again.data);
    for (const SignalInfo& signal : info->signals) {
      if (signal.role != SignalRole::kData) continue;
      ASSERT_EQ(signal.raw(again.data), signal.raw(frame.data)) << name << "." << signal.name;
    }
  }
}

TEST(Schema, EveryMessageRoundTrips) {
  round_trip<message::GroundHeartbeat>("ground_heartbeat");
  round_trip<message::EmergencyStop>("emergency_stop");
  round_trip<message::Heartbeat>("heartbeat");
  round_trip<message::Command>("command");
  round_trip<message::CommandAck>("command_ack");
  round_trip<message::Attitude>("attitude");
  round_trip<message::Leveling>("leveling");
  round_trip<message::Encoders>("encoders");
  round_trip<message::Motors>("motors");
  round_trip<message::Odometry>("odometry");
  round_trip<message::AccelRaw>("accel_raw");
  round_trip<message::GyroRaw>("gyro_raw");
  round_trip<message::MagRaw>("mag_raw");
  round_trip<message::Baro>("baro");
  round_trip<message::Power>("power");
  round_trip<message::Health>("health");
  round_trip<message::ParamValue>("param_value");
  round_trip<message::ParamStage>("param_stage");
  round_trip<message::Event>("event");
  round_trip<message::Link>("link");
  round_trip<message::Time>("time");
}

TEST(Schema, PackWritesEveryByteButTheCrc) {
  uint8_t data[8] = {0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA, 0xAA};
  message::Health{}.pack(data);
  EXPECT_EQ(data[0], 0xAA);
  for (int i = 1; i < message::Health::kSize; ++i) EXPECT_EQ(data[i], 0) << i;
  EXPECT_EQ(data[7], 0xAA) << "beyond the message";
}

TEST(Schema, TheRawVectorsHaveOneLayout) {
  // telemetry.cpp packs all three with the same code.
  for (const char* other : {"gyro_raw", "mag_raw"}) {
    const MessageInfo& it = *find_message(std::string_view(other));
    const MessageInfo& accel = *find_message(std::string_view("accel_raw"));
    ASSERT_EQ(it.signals.size(), accel.signals.size());
    EXPECT_EQ(it.size, accel.size);
    for (size_t i = 0; i < it.signals.size(); ++i) {
      EXPECT_STREQ(it.signals[i].name, accel.signals[i].name);
      EXPECT_EQ(it.signals[i].start, accel.signals[i].start);
      EXPECT_EQ(it.signals[i].length, accel.signals[i].length);
      EXPECT_EQ(it.signals[i].is_signed, accel.signals[i].is_signed);
    }
  }
}

TEST(Schema, ValuesAndTexts) {
  const SignalInfo& pitch = *find_signal("attitude.pitch").signal;
  EXPECT_STREQ(pitch.unit, "deg");
  EXPECT_DOUBLE_EQ(pitch.value(-1234), -12.34);
  EXPECT_EQ(pitch.text(-1234), "-12.34");
  EXPECT_EQ(pitch.text(-5), "-0.05");
  EXPECT_EQ(pitch.text(0), "0.00");
  EXPECT_EQ(pitch.shown(-5), "-0.05 deg");
  // Steps of 1/480 degC from 42.5 degC: 42.5 - 10800 / 480 = 20.00003600 with the schema's digits.
  const SignalInfo& temperature = *find_signal("baro.temperature").signal;
  EXPECT_EQ(temperature.text(-10800), "20.00003600");
  EXPECT_EQ(temperature.shown(-10800), "20.000 degC");
  EXPECT_EQ(temperature.shown(-20401), "-0.002 degC");
  const SignalInfo& edges = *find_signal("encoders.left").signal;
  EXPECT_EQ(edges.shown(1), "1 count");
  EXPECT_EQ(edges.shown(130), "130 counts");
  const SignalInfo& pressure = *find_signal("BARO.pressure").signal;
  EXPECT_DOUBLE_EQ(pressure.value(1013 * 256 + 1), 101300.390625);
  EXPECT_EQ(pressure.text(UINT32_MAX), "1677721599.609375");
  const SignalInfo& state = *find_signal("heartbeat.state").signal;
  EXPECT_EQ(state.text(2), "running");
  EXPECT_EQ(state.text(15), "15") << "no name";
  EXPECT_EQ(find_signal("encoders.interval").signal->text(2500), "10000");
}

TEST(Schema, FindsMessagesOfEveryRobot) {
  EXPECT_STREQ(find_message(uint16_t{0x210})->name, "ATTITUDE");
  EXPECT_STREQ(find_message(uint16_t{0x2F0})->name, "ATTITUDE");
  EXPECT_EQ(find_message(uint16_t{0x200}), nullptr) << "node 0 is the ground";
  EXPECT_STREQ(find_message(uint16_t{0x000})->name, "GROUND_HEARTBEAT");
  EXPECT_EQ(find_message(uint16_t{0x20}), find_message(uint16_t{0x10}));
  EXPECT_EQ(find_message(uint16_t{0xFFFF}), nullptr);
  EXPECT_EQ(find_message(std::string_view("nothing")), nullptr);
  EXPECT_EQ(id_of_node(0x210, 3), 0x230);
  EXPECT_EQ(id_of_node(0x001, 3), 0x001);
}

TEST(Schema, FindingASignalSaysWhatThereIs) {
  const auto said = [](const char* path) -> std::string {
    try {
      find_signal(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(said("attitude.pitch"), "");
  EXPECT_NE(said("altitude.pitch").find("ground_heartbeat, "), std::string::npos);
  EXPECT_EQ(said("attitude.yaw"),
            "attitude.yaw: no signal of this name; attitude has crc, counter, roll, pitch, "
            "heading");
  EXPECT_NE(said("attitude"), "");
}

TEST(Schema, ChecksFrames) {
  CanFrame frame = frame_of(message::Attitude{1, 2, 3});
  EXPECT_EQ(check_frame(frame), FrameFault::kWrongCrc);
  e2e_protect(frame.id, 0, frame.data, frame.size);
  EXPECT_EQ(check_frame(frame), FrameFault::kNone);
  frame.size = 7;
  e2e_protect(frame.id, 0, frame.data, frame.size);
  EXPECT_EQ(check_frame(frame), FrameFault::kWrongSize);
  frame.id = 0x21F;
  EXPECT_EQ(check_frame(frame), FrameFault::kUnknownId);
  EXPECT_EQ(check_frame(frame_of(message::Command{})), FrameFault::kNone) << "has a MAC, no CRC";
}

/// The schema itself, as the compiler reads it.
schema::Database dbc() {
  return schema::read_dbc("firmware/protocol/screed.dbc");
}

TEST(Schema, TablesHoldTheNamesOfTheFile) {
  size_t named = 0;
  for (const schema::DbcMessage& message : dbc().messages) {
    const MessageInfo* const info = find_message(message.name);
    ASSERT_NE(info, nullptr) << message.name;
    EXPECT_EQ(info->period_ms, message.period_ms()) << message.name;
    for (const schema::DbcSignal& signal : message.signals) {
      const std::string path = message.name + "." + signal.name;
      const SignalInfo* const it = info->signal(signal.name);
      ASSERT_NE(it, nullptr) << path;
      EXPECT_EQ(it->comment, signal.comment) << path;
      EXPECT_EQ(it->flags, signal.flags()) << path;
      EXPECT_EQ(it->start, signal.start) << path;
      ASSERT_EQ(it->values.size(), signal.values.size()) << path;
      std::vector<std::string> names;
      for (const schema::ValueName& value : signal.values) {
        EXPECT_EQ(it->text(value.value), value.name) << path;
        names.push_back(value.name);
      }
      EXPECT_EQ(value_names(std::string(info->title) + "." + signal.name), names);
      named += names.size();
    }
  }
  EXPECT_GT(named, 30U);
}

TEST(Schema, TheFirmwaresEnumerationsAreThoseOfTheTables) {
  const auto name = [](const char* path, auto value) {
    return find_signal(path).signal->text(static_cast<int64_t>(value));
  };
  EXPECT_EQ(name("heartbeat.state", RobotState::kStopped), "stopped");
  EXPECT_EQ(name("leveling.state", LevelingState::kTrainingDrive), "training_drive");
  EXPECT_EQ(name("leveling.algorithm", LevelingAlgorithm::kSpinOnPeak), "spin_on_peak");
  EXPECT_EQ(name("health.reset_cause", avr::ResetCause::kBrownOut), "brown_out");
  EXPECT_EQ(name("event.code", message::EventCode::kLockedOut), "locked_out");
  EXPECT_THROW(value_names("leveling.colour"), InputError);
}

TEST(Schema, FlagsHaveTheNamesOfTheirBits) {
  EXPECT_EQ(flag_names("heartbeat", "faults", 0), "");
  EXPECT_EQ(flag_names("heartbeat", "faults", Fault::kStuck), "stuck");
  EXPECT_EQ(flag_names("heartbeat", "faults", Fault::kGyroChip | Fault::kTilt), "tilt, gyro_chip");
  EXPECT_EQ(flag_names("health", "conditions", ChipBit::kBaroChip | ChipBit::kAccelMagChip),
            "accel_mag_chip, baro_chip");
  EXPECT_EQ(flag_names("health", "conditions", 0x80), "") << "a bit without a name";
  EXPECT_THROW(flag_names("heart", "faults", 1), InputError);
  // Every bit by itself, as the file has it.
  unsigned bits = 0;
  for (const schema::DbcMessage& message : dbc().messages) {
    for (const schema::Field& field : schema::fields_of(message)) {
      if (field.signals.front()->flags().empty()) continue;
      for (const schema::DbcSignal* flag : field.signals) {
        EXPECT_EQ(flag_names(message.name, field.name, 1U << (flag->start - field.start)),
                  flag->name);
        ++bits;
      }
    }
  }
  EXPECT_GT(bits, 16U);
}

}  // namespace
}  // namespace screed
