// The ways frames travel: serial port with and without the XBee's API mode, and the port of a
// simulation.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "firmware/protocol/e2e.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/can_link.h"
#include "host_sim/ground_station/link/external_port.h"
#include "host_sim/ground_station/link/pseudo_terminal.h"
#include "host_sim/ground_station/link/serial_link.h"
#include "host_sim/ground_station/station/ground_station.h"
#include "tests/temp_folder.h"

namespace screed {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

std::vector<uint8_t> text(const std::string& characters) {
  return {characters.begin(), characters.end()};
}

class LinkTest : public ::testing::Test {
 protected:
  /// What arrives until there are `count` frames or nothing more comes.
  static std::vector<LinkFrame> frames_of(Link& link, size_t count = 1) {
    std::vector<LinkFrame> frames;
    for (int i = 0; i < 20 && frames.size() < count; ++i) link.receive(milliseconds(50), frames);
    return frames;
  }

  const TempFolder temporary_;
  const fs::path folder_ = temporary_.path();
};

TEST_F(LinkTest, LinesOfASerialPortBecomeFrames) {
  PseudoTerminal device(folder_ / "radio");
  SerialLink link(folder_ / "radio", {});
  EXPECT_TRUE(link.status().up);
  // What slcand and people send when they attach is no frame and no error.
  device.write(text("C\rS6\rO\rt2103AABBCC\rt21\rt0100\r"));
  const std::vector<LinkFrame> frames = frames_of(link, 2);
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(frames[0].frame.id, 0x210);
  EXPECT_EQ(frames[0].frame.size, 3);
  EXPECT_EQ(frames[0].frame.data[2], 0xCC);
  EXPECT_GT(frames[0].time_us, 1'500'000'000'000'000U);
  EXPECT_FALSE(frames[0].source.has_value());
  EXPECT_EQ(frames[1].frame.id, 0x010);
  EXPECT_EQ(link.status().received, 2U);
  EXPECT_EQ(link.status().refused, 1U);
}

// Whatever part of the lines was read before the rest was thrown away, however they were cut.
TEST_F(LinkTest, LinesThatNobodyReadsInTimeAreLostWhole) {
  const auto line = [](int i) {
    char characters[32];
    std::snprintf(characters, sizeof characters, "t%03X8%08X%08X\r", i % 0x700, i, i);
    return std::string(characters);
  };
  PseudoTerminal device(folder_ / "radio");
  FileDescriptor reader(open((folder_ / "radio").c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  ASSERT_TRUE(reader.is_open());
  std::string sent;
  for (int i = 0; i < 4000; ++i) sent += line(i);
  std::string got;
  size_t cut = 1;
  for (size_t at = 0; at < sent.size(); at += cut) {
    cut = 1 + (cut * 7 + 5) % 53;
    device.write(text(sent.substr(at, cut)));
    if (at % 5000 > 200) continue;
    std::array<char, 37> some{};
    const ssize_t count = read(reader.get(), some.data(), some.size());
    if (count > 0) got.append(some.data(), static_cast<size_t>(count));
  }
  std::array<char, 8192> rest{};
  ssize_t count = 0;
  while ((count = read(reader.get(), rest.data(), rest.size())) > 0)
    got.append(rest.data(), static_cast<size_t>(count));
  std::istringstream lines(got);
  int whole = 0;
  int last = -1;
  for (std::string one; std::getline(lines, one, '\r');) {
    EXPECT_TRUE(one.empty() || one[0] == 't') << one;
    if (one.size() < line(0).size() - 1) continue;
    ++whole;
    const int i = std::stoi(one.substr(5, 8), nullptr, 16);
    EXPECT_EQ(one + '\r', line(i));
    EXPECT_GT(i, last);
    last = i;
  }
  EXPECT_GT(whole, 100);
  EXPECT_LT(whole, 4000);
}

TEST_F(LinkTest, FramesGoOutAsLines) {
  PseudoTerminal device(folder_ / "radio");
  std::optional<SerialLink> link(std::in_place, folder_ / "radio", SerialOptions{});
  EXPECT_EQ(device.read(), text("\rO\r")) << "SLCAN's open, which a board on USB waits for";
  EXPECT_TRUE(link->send({0x110, 2, {0x12, 0xAB}}));
  EXPECT_EQ(device.read(), text("t110212AB\r"));
  EXPECT_EQ(link->status().sent, 1U);
  link.reset();
  EXPECT_EQ(device.read(), text("\rC\r"));
}

TEST_F(LinkTest, AStickThatIsPulledAndPutBackGoesOn) {
  std::optional<PseudoTerminal> stick(folder_ / "radio");
  SerialLink link(folder_ / "radio", {});
  stick->write(text("t0100\r"));
  EXPECT_EQ(frames_of(link).size(), 1U);

  stick.reset();
  std::vector<LinkFrame> frames;
  link.receive(milliseconds(10), frames);
  EXPECT_FALSE(link.status().up);
  EXPECT_NE(link.status().text.find("waiting"), std::string::npos);
  EXPECT_FALSE(link.send({0x010, 0, {}}));
  EXPECT_EQ(link.status().not_sent, 1U);

  stick.emplace(folder_ / "radio");
  for (int i = 0; i < 40 && !link.status().up; ++i) link.receive(milliseconds(50), frames);
  ASSERT_TRUE(link.status().up);
  EXPECT_EQ(link.status().text, "up");
  EXPECT_EQ(link.status().interruptions, 1U);
  stick->write(text("t0110\r"));
  frames = frames_of(link);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].frame.id, 0x011);
}

TEST_F(LinkTest, AStickThatComesBackAsAnotherTtyIsFoundByWhatItIs) {
  fs::create_directory(folder_ / "by-id");
  std::optional<PseudoTerminal> first(folder_ / "ttyUSB0");
  std::optional<PseudoTerminal> by_id;
  fs::create_symlink(folder_ / "ttyUSB0", folder_ / "by-id" / "usb-Digi_XBee");
  SerialOptions options;
  options.by_id = folder_ / "by-id";
  SerialLink link(folder_ / "ttyUSB0", options);

  first.reset();
  fs::remove(folder_ / "by-id" / "usb-Digi_XBee");
  std::vector<LinkFrame> frames;
  link.receive(milliseconds(10), frames);
  EXPECT_FALSE(link.status().up);

  PseudoTerminal second(folder_ / "ttyUSB1");
  fs::create_symlink(folder_ / "ttyUSB1", folder_ / "by-id" / "usb-Digi_XBee");
  for (int i = 0; i < 40 && !link.status().up; ++i) link.receive(milliseconds(50), frames);
  second.write(text("t0100\r"));
  EXPECT_EQ(frames_of(link).size(), 1U);
}

TEST_F(LinkTest, WrongPortsAreRefusedInOneLine) {
  const auto refusal = [](const fs::path& device, const SerialOptions& options = {}) {
    try {
      SerialLink link(device, options);
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  SerialOptions here;
  here.devices = folder_;
  EXPECT_EQ(refusal(folder_ / "none", here),
            (folder_ / "none").string() + ": no such port; serial ports here: none");
  for (const char* name : {"ttyUSB1", "ttyACM0", "ttyS0", "tty1"}) std::ofstream(folder_ / name);
  EXPECT_EQ(refusal(folder_ / "none", here),
            (folder_ / "none").string() + ": no such port; serial ports here: " +
                (folder_ / "ttyACM0").string() + ", " + (folder_ / "ttyUSB1").string());
  std::ofstream(folder_ / "file") << "text";
  EXPECT_NE(refusal(folder_ / "file").find("not a serial port"), std::string::npos);
  PseudoTerminal device(folder_ / "radio");
  SerialOptions odd;
  odd.baud = 1234;
  EXPECT_NE(refusal(folder_ / "radio", odd).find("57600"), std::string::npos);
  const SerialLink holder(folder_ / "radio", {});
  EXPECT_NE(refusal(folder_ / "radio").find("another program holds it"), std::string::npos);
}

TEST_F(LinkTest, APortNobodyReadsKeepsNothingOld) {
  PseudoTerminal device(folder_ / "radio");
  for (int i = 0; i < 2000; ++i) device.write(text("t2103AABBCC\r"));
  SerialLink link(folder_ / "radio", {});
  device.write(text("t0100\r"));
  const std::vector<LinkFrame> frames = frames_of(link);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].frame.id, 0x010);
}

TEST_F(LinkTest, ALinkOfTheUsersIsNotOverwritten) {
  std::ofstream(folder_ / "notes") << "text";
  EXPECT_THROW(PseudoTerminal(folder_ / "notes"), InputError);
  EXPECT_TRUE(fs::exists(folder_ / "notes"));
  { const PseudoTerminal device(folder_ / "radio"); }
  EXPECT_FALSE(fs::is_symlink(folder_ / "radio"));
}

// ---- the XBee's API mode

TEST(XbeeApi, FramesOfTheManualAreUnderstood) {
  // Digi, "XBee/XBee-PRO Zigbee RF Modules User Guide", examples of frames 0x90 and 0x8B.
  const std::vector<uint8_t> bytes = {
      0x7E, 0x00, 0x12, 0x90, 0x00, 0x13, 0xA2, 0x00, 0x40, 0x52, 0x2B,
      0xAA, 0x7D, 0x84, 0x01, 0x52, 0x78, 0x44, 0x61, 0x74, 0x61, 0x0D,   // RxData
      0x7E, 0x00, 0x07, 0x8B, 0x01, 0x7D, 0x84, 0x00, 0x00, 0x01, 0x71};  // delivered
  XbeeApiParser parser(XbeeApiMode::kPlain);
  std::vector<XbeeFrame> frames;
  for (const uint8_t byte : bytes) parser.feed(byte, frames);
  ASSERT_EQ(frames.size(), 2U);
  const auto packet = received_packet(frames[0]);
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->source.address, 0x0013A20040522BAAU);
  EXPECT_FALSE(packet->source.rssi_dbm.has_value());
  EXPECT_EQ(packet->data, text("RxData"));
  EXPECT_EQ(delivered(frames[1]), true);
  EXPECT_EQ(parser.refused(), 0U);
}

// Digi's user guide, frames 0x89 and 0x8B: a status of 0 is success; the other bytes say nothing of
// it.
TEST(XbeeApi, ATransmitStatusIsReadFromItsOwnByte) {
  // Frame id, address of 16 bits, retries, delivery status, discovery status.
  const auto status = [](std::vector<uint8_t> content) {
    return delivered({XbeeFrameType::kTransmitStatus, std::move(content)});
  };
  EXPECT_EQ(status({0x01, 0x7D, 0x84, 0x03, 0x00, 0x01}), true)
      << "after three retries and a search";
  EXPECT_EQ(status({0x01, 0x00, 0x00, 0x00, 0x21, 0x00}), false)
      << "no acknowledgement by the network";
  EXPECT_EQ(status({0x00, 0xFF, 0xFE, 0x00, 0x02, 0x00}), false) << "the channel was never free";
  EXPECT_EQ(status({0x01, 0x7D, 0x84, 0x00, 0x00}), std::nullopt) << "cut";
  // Frame id, status.
  const auto plain = [](std::vector<uint8_t> content) {
    return delivered({XbeeFrameType::kTransmitStatusPlain, std::move(content)});
  };
  EXPECT_EQ(plain({0x01, 0x00}), true);
  EXPECT_EQ(plain({0x00, 0x01}), false) << "no acknowledgement";
  EXPECT_EQ(plain({0x01}), std::nullopt);
  EXPECT_EQ(delivered({XbeeFrameType::kReceive, {0, 0, 0, 0, 0, 0}}), std::nullopt);
}

// Frame id, the command's two letters, status, value: the guide's frame 0x88.
TEST(XbeeApi, OnlyAGoodAnswerToDbIsAnRssi) {
  const auto rssi_dbm = [](std::vector<uint8_t> content) {
    return answered_rssi_dbm({XbeeFrameType::kCommandResponse, std::move(content)});
  };
  EXPECT_EQ(rssi_dbm({0x00, 'D', 'B', 0, 0x1C}), -28);
  EXPECT_EQ(rssi_dbm({0x01, 'D', 'B', 1, 0x1C}), std::nullopt) << "an error";
  EXPECT_EQ(rssi_dbm({0x01, 'D', 'L', 0, 0x1C}), std::nullopt);
  EXPECT_EQ(rssi_dbm({0x01, 'E', 'B', 0, 0x1C}), std::nullopt);
  EXPECT_EQ(rssi_dbm({0x01, 'D', 'B', 0}), std::nullopt) << "no value";
  EXPECT_EQ(answered_rssi_dbm({XbeeFrameType::kReceive, {0x00, 'D', 'B', 0, 0x1C}}), std::nullopt);
}

TEST(XbeeApi, AddressAndDataStandWhereTheGuideHasThem) {
  // 0x80: address of 64 bits, RSSI, options. 0x91: two addresses, endpoints, cluster, profile,
  // options.
  const auto far =
      received_packet({XbeeFrameType::kReceive64,
                       {0, 0x13, 0xA2, 0, 0x40, 0x52, 0x2B, 0xAA, 0x3C, 0x00, 'a', 'b'}});
  ASSERT_TRUE(far.has_value());
  EXPECT_EQ(far->source.address, 0x0013A20040522BAAU);
  EXPECT_EQ(far->source.rssi_dbm, -60);
  EXPECT_EQ(far->data, text("ab"));
  const auto explicit_one = received_packet({XbeeFrameType::kReceiveExplicit,
                                             {0, 0x13, 0xA2, 0, 0x40, 0x52, 0x2B, 0xAA, 0x7D, 0x84,
                                              0xE0, 0xE0, 0x22, 0x11, 0xC1, 0x05, 0x02, 'c'}});
  ASSERT_TRUE(explicit_one.has_value());
  EXPECT_EQ(explicit_one->source.address, 0x0013A20040522BAAU);
  EXPECT_FALSE(explicit_one->source.rssi_dbm.has_value());
  EXPECT_EQ(explicit_one->data, text("c"));
}

// Zigbee's 0x10: frame id, 64-bit broadcast, 16-bit "unknown", radius, options. 802.15.4's 0x00:
// frame id, broadcast, options. No frame id, no status that nobody waits for.
TEST(XbeeApi, RequestsAreLaidOutAsTheGuideSays) {
  const std::vector<uint8_t> data = text("t0010\r");
  const auto with_data = [&data](std::vector<uint8_t> head) {
    head.insert(head.end(), data.begin(), data.end());
    return head;
  };
  const XbeeFrame zigbee = broadcast_request(data, XbeeFrameType::kReceive);
  EXPECT_EQ(zigbee.type, static_cast<XbeeFrameType>(0x10));
  EXPECT_EQ(zigbee.content, with_data({0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFE, 0, 0}));
  const XbeeFrame plain = broadcast_request(data, XbeeFrameType::kReceive16);
  EXPECT_EQ(plain.type, static_cast<XbeeFrameType>(0x00));
  EXPECT_EQ(plain.content, with_data({0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF, 0}));
}

TEST(XbeeApi, EscapedFramesOfTheManual) {
  // The user guide's own example of mode 2: a remote AT command of two bytes, 0x23 0x11.
  const XbeeFrame frame = {static_cast<XbeeFrameType>(0x23), {0x11}};
  const std::vector<uint8_t> expected = {0x7E, 0x00, 0x02, 0x23, 0x7D, 0x31, 0xCB};
  EXPECT_EQ(encode_xbee(frame, XbeeApiMode::kEscaped), expected);
  XbeeApiParser parser(XbeeApiMode::kEscaped);
  std::vector<XbeeFrame> frames;
  for (const uint8_t byte : expected) parser.feed(byte, frames);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].content, std::vector<uint8_t>{0x11});
}

TEST(XbeeApi, RssiOfThe802154Modules) {
  XbeeFrame frame{XbeeFrameType::kReceive16, {0x56, 0x78, 0x28, 0x00, 't'}};
  const auto packet = received_packet(frame);
  ASSERT_TRUE(packet.has_value());
  EXPECT_EQ(packet->source.address, 0x5678U);
  EXPECT_EQ(packet->source.rssi_dbm, -40);
  EXPECT_EQ(packet->data, text("t"));
  frame.content.resize(3);
  EXPECT_FALSE(received_packet(frame).has_value());
  EXPECT_EQ(answered_rssi_dbm({XbeeFrameType::kCommandResponse, {0x52, 'D', 'B', 0, 0x46}}), -70);
}

TEST(XbeeApi, DamageCostsTheDamagedFrameAlone) {
  for (const XbeeApiMode mode : {XbeeApiMode::kPlain, XbeeApiMode::kEscaped}) {
    const XbeeFrame frame{XbeeFrameType::kReceive16, {0x00, 0x7E, 0x28, 0x00, 0x7D, 0x11, 0x13}};
    const std::vector<uint8_t> good = encode_xbee(frame, mode);
    for (size_t at = 0; at < good.size(); ++at) {
      std::vector<uint8_t> bytes = good;
      bytes[at] = static_cast<uint8_t>(bytes[at] ^ 0x04);
      std::vector<XbeeFrame> frames;
      XbeeApiParser parser(mode);
      for (const uint8_t byte : bytes) parser.feed(byte, frames);
      // A wrong length may swallow what follows until the next start byte, no more.
      for (int i = 0; i < 40; ++i) {
        for (const uint8_t byte : good) parser.feed(byte, frames);
      }
      for (const XbeeFrame& got : frames) EXPECT_EQ(got.content, frame.content) << at;
      EXPECT_GE(frames.size(), mode == XbeeApiMode::kEscaped ? 39U : 1U) << at;
    }
  }
}

TEST_F(LinkTest, RobotsBehindOneRadioAreToldApart) {
  PseudoTerminal device(folder_ / "radio");
  SerialOptions options;
  options.api = XbeeApiMode::kEscaped;
  SerialLink link(folder_ / "radio", options);
  // The line of each robot comes in two packets, and the packets take turns.
  const auto packet = [&](uint8_t robot, uint8_t rssi, const std::string& data) {
    XbeeFrame frame{XbeeFrameType::kReceive16, {0x00, robot, rssi, 0x00}};
    for (const char character : data) frame.content.push_back(static_cast<uint8_t>(character));
    device.write(encode_xbee(frame, XbeeApiMode::kEscaped));
  };
  packet(1, 40, "t2103AA");
  packet(2, 71, "t2203DD");
  packet(1, 41, "BBCC\r");
  packet(2, 70, "EEFF\r");
  const std::vector<LinkFrame> frames = frames_of(link, 2);
  ASSERT_EQ(frames.size(), 2U);
  ASSERT_TRUE(frames[0].source.has_value() && frames[1].source.has_value());
  EXPECT_EQ(frames[0].source->address, 1U);
  EXPECT_EQ(frames[0].source->rssi_dbm, -41);
  EXPECT_EQ(frames[0].frame.id, 0x210);
  EXPECT_EQ(frames[1].source->address, 2U);
  EXPECT_EQ(frames[1].frame.id, 0x220);
  EXPECT_EQ(link.status().rssi_dbm, -70);

  // What the module could not deliver is an error; what it could, none.
  device.write(encode_xbee({XbeeFrameType::kTransmitStatusPlain, {1, 0}}, XbeeApiMode::kEscaped));
  device.write(encode_xbee({XbeeFrameType::kTransmitStatusPlain, {1, 1}}, XbeeApiMode::kEscaped));
  packet(1, 40, "t2103AABBCC\r");
  frames_of(link);
  EXPECT_EQ(link.status().errors, 1U);

  // Answers go out in the kind of request these modules understand.
  EXPECT_TRUE(link.send({0x001, 0, {}}));
  XbeeApiParser parser(XbeeApiMode::kEscaped);
  std::vector<XbeeFrame> sent;
  for (const uint8_t byte : device.read()) parser.feed(byte, sent);
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].type, XbeeFrameType::kTransmit64);
  EXPECT_EQ(std::string(sent[0].content.begin() + 10, sent[0].content.end()), "t0010\r");
}

// What a module sends in each setting, read with each: the one that fits is named.
TEST_F(LinkTest, AWrongApiSettingIsNamed) {
  constexpr std::optional<XbeeApiMode> kSettings[] = {std::nullopt, XbeeApiMode::kPlain,
                                                      XbeeApiMode::kEscaped};
  const std::string expected[] = {
      "lines of a transparent module come in: leave out --api, or set the module's AP to 1",
      "packets of API mode 1 come in: --api 1 reads them",
      "packets of API mode 2 come in: --api 2 reads them"};
  for (size_t module = 0; module < 3; ++module) {
    for (size_t chosen = 0; chosen < 3; ++chosen) {
      PseudoTerminal device(folder_ / "radio");
      SerialOptions options;
      options.api = kSettings[chosen];
      SerialLink link(folder_ / "radio", options);
      for (int i = 0; i < 8; ++i) {
        // From the 64-bit address of a module of Digi; 0x13 and 0x7D are escaped.
        XbeeFrame frame{XbeeFrameType::kReceive64, {0x00, 0x13, 0xA2, 0x00, 0x7D, 2, 3, 4, 40, 0}};
        const std::string line = "t2103AABBCC\r";
        frame.content.insert(frame.content.end(), line.begin(), line.end());
        device.write(module == 0 ? text(line) : encode_xbee(frame, *kSettings[module]));
      }
      std::vector<LinkFrame> frames;
      for (int i = 0; i < 3; ++i) link.receive(milliseconds(10), frames);
      EXPECT_EQ(link.status().hint, module == chosen ? "" : expected[module])
          << "module " << module << ", chosen " << chosen;
      EXPECT_EQ(frames.size(), module == chosen ? 8U : 0U);
    }
  }
}

TEST_F(LinkTest, BytesOfAnotherBaudRateAreNamed) {
  PseudoTerminal device(folder_ / "radio");
  SerialLink link(folder_ / "radio", {});
  for (int i = 0; i < 5; ++i) device.write(std::vector<uint8_t>(250, 0xF0));
  std::vector<LinkFrame> frames;
  for (int i = 0; i < 3; ++i) link.receive(milliseconds(10), frames);
  EXPECT_EQ(link.status().hint, "bytes come in that are no lines: does --baud fit the module?");
}

// ---- SocketCAN: what can be said without an interface; the rest is tests/can

TEST(CanLink, WithoutCanOrInterfaceOneClearLine) {
  try {
    CanLink link("screed-none");
    FAIL() << "there is no such interface";
  } catch (const std::runtime_error& error) {
    const std::string line = error.what();
    EXPECT_TRUE(line.find("kernel has no CAN") != std::string::npos ||
                line.find("no such interface") != std::string::npos)
        << line;
  }
  EXPECT_THROW(CanLink("a-name-that-is-too-long"), InputError);
}

// ---- the ground end of a simulated radio

class RecordingPort : public GroundPort {
 public:
  void send(std::span<const uint8_t> bytes) override {
    given.insert(given.end(), bytes.begin(), bytes.end());
  }
  std::vector<uint8_t> receive() override { return std::exchange(waiting, {}); }

  std::vector<uint8_t> given;
  std::vector<uint8_t> waiting;
};

class GroundEndTest : public ::testing::Test {
 protected:
  std::vector<uint8_t> tick() {
    end_.tick(now_us_, station_, uplink_, downlink_);
    now_us_ += 10000;
    const std::span<const uint8_t> arrived = uplink_.receive(now_us_, SIZE_MAX);
    return {arrived.begin(), arrived.end()};
  }
  static std::vector<uint8_t> heartbeat_line(bool right) {
    CanFrame frame{kIdGroundHeartbeat, 6, {}};
    e2e_protect(frame.id, 1, frame.data, frame.size);
    if (!right) frame.data[3] ^= 1U;
    std::vector<uint8_t> line(kSlcanLineMax);
    line.resize(slcan_encode(frame, line.data()));
    return line;
  }

  uint64_t now_us_ = 10000;
  RecordingPort port_;
  GroundStation station_{false, std::nullopt, nullptr};
  RadioLink uplink_{1, "uplink", {0.0, 0.0, 1e9}};
  RadioLink downlink_{1, "downlink", {0.0, 0.0, 1e9}};
  GroundEnd end_{&port_};
};

TEST_F(GroundEndTest, WhatComesDownIsGivenOutAndWhatIsWrittenGoesUp) {
  tick();
  downlink_.send(now_us_ - 5000, text("t0100\r"));
  port_.waiting = text("C\rO\r");
  EXPECT_EQ(tick(), text("C\rO\r"));
  EXPECT_EQ(port_.given, text("t0100\r"));
}

TEST_F(GroundEndTest, AStationOutsideTakesOverWithItsFirstHeartbeat) {
  EXPECT_FALSE(tick().empty());  // the simulated station's heartbeat
  port_.waiting = heartbeat_line(false);
  tick();
  EXPECT_FALSE(end_.handed_over());
  port_.waiting = heartbeat_line(true);
  EXPECT_EQ(tick(), heartbeat_line(true));
  EXPECT_TRUE(end_.handed_over());
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(tick().empty());
}

}  // namespace
}  // namespace screed
