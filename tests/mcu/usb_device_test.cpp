// The image as a device on the USB bus: a host enumerates it, breaks off, and pulls the cable.
#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "host_sim/devices/mcu/board.h"
#include "tests/mcu/images.h"
#include "tests/mcu/usb_host.h"

namespace screed::mcu {
namespace {

using Bytes = std::vector<std::uint8_t>;
using Outcome = UsbHost::Outcome;
using Until = UsbHost::Until;

constexpr std::uint64_t kTickCycles = kClock_hz / 100;
constexpr std::uint16_t kUdaddr = 0xE3;
constexpr std::uint8_t kDevice = 1;
constexpr std::uint8_t kConfiguration = 2;
constexpr std::uint8_t kString = 3;

class UsbDevice : public ::testing::Test {
 protected:
  UsbDevice() : board_(kScreedImage, read_wiring(kWiring)), mcu_(board_.mcu), usb_(mcu_) {
    mcu_.run_ms(50);
  }

  /// The control loop has not noticed anything.
  void expect_undisturbed() {
    EXPECT_TRUE(mcu_.alive());
    EXPECT_EQ(mcu_.starts(), 1);
    EXPECT_LT(mcu_.longest_tick(), kTickCycles + 600);
    EXPECT_GT(mcu_.shortest_tick(), kTickCycles - 600);
  }
  void expect_working_console() {
    ASSERT_TRUE(usb_.plug_in());
    ASSERT_TRUE(usb_.set_line(115200, true));
    usb_.send("k\n");
    EXPECT_EQ(usb_.listen_ms(100), "k 00 FF 0001\n");
  }

  Board board_;
  Mcu& mcu_;
  UsbHost usb_;
};

int word_at(const Bytes& bytes, std::size_t at) {
  return bytes[at] | bytes[at + 1] << 8;
}

std::string text_of(const Bytes& descriptor) {
  std::string text;
  for (std::size_t i = 2; i + 1 < descriptor.size(); i += 2) {
    EXPECT_EQ(descriptor[i + 1], 0);
    text += static_cast<char>(descriptor[i]);
  }
  return text;
}

/// The descriptors of a configuration, one by one. Fails when their lengths do not add up.
std::vector<Bytes> parts_of(const Bytes& configuration) {
  std::vector<Bytes> parts;
  for (std::size_t at = 0; at < configuration.size();) {
    const std::size_t size = configuration[at];
    if (size < 2 || at + size > configuration.size()) {
      ADD_FAILURE() << "a descriptor of " << size << " bytes at " << at;
      return {};
    }
    const auto begin = configuration.begin() + static_cast<std::ptrdiff_t>(at);
    parts.emplace_back(begin, begin + static_cast<std::ptrdiff_t>(size));
    at += size;
  }
  return parts;
}

std::vector<Bytes> of_type(const std::vector<Bytes>& parts, std::uint8_t type) {
  std::vector<Bytes> result;
  for (const Bytes& part : parts) {
    if (part[1] == type) result.push_back(part);
  }
  return result;
}

TEST_F(UsbDevice, IsAnAStarOnTheUsbBus) {
  usb_.reset();
  // As Linux begins: whatever fits one packet, before there is an address; then a second reset.
  const Bytes first = usb_.descriptor(kDevice, 0, 64);
  ASSERT_EQ(first.size(), 18U);
  usb_.reset();
  ASSERT_EQ(usb_.tell(0x00, 5, 42), Outcome::kDone);
  const Bytes device = usb_.descriptor(kDevice, 0, 18);
  ASSERT_EQ(device, first);
  EXPECT_EQ(device[1], kDevice);
  EXPECT_EQ(word_at(device, 2), 0x0200);
  EXPECT_EQ(device[7], 64);
  EXPECT_EQ(word_at(device, 8), 0x1FFB);
  EXPECT_EQ(word_at(device, 10), 0x2300);
  EXPECT_EQ(device[17], 1) << "configurations";
  // The class of a function with an interface association (ECN).
  EXPECT_EQ(Bytes(device.begin() + 4, device.begin() + 7), (Bytes{0xEF, 0x02, 0x01}));

  EXPECT_EQ(usb_.descriptor(kString, 0, 255), (Bytes{4, kString, 0x09, 0x04}));
  EXPECT_EQ(text_of(usb_.descriptor(kString, device[14], 255)), "Pololu Corporation");
  EXPECT_EQ(text_of(usb_.descriptor(kString, device[15], 255)), "Pololu A-Star 32U4");
  EXPECT_EQ(device[16], 0) << "no serial number";
  expect_undisturbed();
}

TEST_F(UsbDevice, DescribesASerialLine) {
  usb_.reset();
  const Bytes head = usb_.descriptor(kConfiguration, 0, 9);
  ASSERT_EQ(head.size(), 9U);
  const auto total = static_cast<std::uint16_t>(word_at(head, 2));
  const Bytes all = usb_.descriptor(kConfiguration, 0, total);
  ASSERT_EQ(all.size(), total);
  EXPECT_EQ(usb_.descriptor(kConfiguration, 0, 1000), all);
  EXPECT_EQ(all[4], 2) << "interfaces";
  EXPECT_EQ(all[5], 1) << "value for SET_CONFIGURATION";
  EXPECT_EQ(all[7] & 0x80, 0x80);

  const std::vector<Bytes> parts = parts_of(all);
  const std::vector<Bytes> interfaces = of_type(parts, 4);
  ASSERT_EQ(interfaces.size(), 2U);
  EXPECT_EQ(interfaces[0], (Bytes{9, 4, 0, 0, 1, 0x02, 0x02, 0x00, 0})) << "abstract control model";
  EXPECT_EQ(interfaces[1], (Bytes{9, 4, 1, 0, 2, 0x0A, 0x00, 0x00, 0})) << "data";
  const std::vector<Bytes> associations = of_type(parts, 11);
  ASSERT_EQ(associations.size(), 1U);
  EXPECT_EQ(associations[0], (Bytes{8, 11, 0, 2, 0x02, 0x02, 0x00, 0}));

  const std::vector<Bytes> functional = of_type(parts, 0x24);
  ASSERT_EQ(functional.size(), 4U);
  EXPECT_EQ(functional[0][2], 0x00) << "the header comes first (CDC 1.2, 5.2.3)";
  EXPECT_EQ(functional[2], (Bytes{4, 0x24, 0x02, 0x02})) << "line coding and control line state";
  EXPECT_EQ(functional[3], (Bytes{5, 0x24, 0x06, 0, 1})) << "interface 0 controls 1";

  std::set<int> addresses;
  for (const Bytes& endpoint : of_type(parts, 5)) {
    ASSERT_EQ(endpoint.size(), 7U);
    EXPECT_TRUE(addresses.insert(endpoint[2]).second);
    const bool bulk = (endpoint[3] & 3) == 2;
    EXPECT_EQ(word_at(endpoint, 4), bulk ? 64 : 16);
    EXPECT_TRUE(bulk || endpoint[6] > 0) << "an interval";
  }
  EXPECT_EQ(addresses, (std::set<int>{0x81, 0x02, 0x83}));
}

TEST_F(UsbDevice, GivesAsMuchAsIsAskedFor) {
  usb_.reset();
  const Bytes all = usb_.descriptor(kConfiguration, 0, 255);
  const auto size = static_cast<std::uint16_t>(all.size());
  for (std::uint16_t length = 1; length < size; ++length) {
    EXPECT_EQ(usb_.descriptor(kConfiguration, 0, length), Bytes(all.begin(), all.begin() + length));
  }
  EXPECT_EQ(usb_.tell(0x80, 6, kDevice << 8), Outcome::kDone) << "nothing at all";
  expect_undisturbed();
}

TEST_F(UsbDevice, HasItsNewAddressWithin2Ms) {
  for (int i = 0; i < 20; ++i) {
    usb_.run_ms(0.7);  // another phase of the tick
    usb_.reset();
    EXPECT_EQ(mcu_.memory(kUdaddr), 0);
    ASSERT_EQ(usb_.tell(0x00, 5, 17), Outcome::kDone);
    usb_.run_ms(2);
    EXPECT_EQ(mcu_.memory(kUdaddr), 0x80 | 17);
  }
  // Not before the status stage, which goes to the old one.
  usb_.reset();
  Bytes none;
  usb_.transfer({0x00, 5, 18, 0, 0}, none, Until::kStatus);
  usb_.run_ms(100);
  EXPECT_EQ(mcu_.memory(kUdaddr), 18);
  expect_undisturbed();
}

TEST_F(UsbDevice, AnswersTheRequestsOfChapter9) {
  usb_.reset();
  ASSERT_EQ(usb_.tell(0x00, 5, 1), Outcome::kDone);
  EXPECT_EQ(usb_.ask(0x80, 8, 0, 1), Bytes{0}) << "not configured";
  EXPECT_EQ(usb_.tell(0x00, 9, 2), Outcome::kStalled) << "no such configuration";
  EXPECT_EQ(usb_.tell(0x00, 9, 1), Outcome::kDone);
  EXPECT_EQ(usb_.ask(0x80, 8, 0, 1), Bytes{1});
  EXPECT_EQ(usb_.ask(0x80, 0, 0, 2), (Bytes{0, 0})) << "powered by the bus";
  EXPECT_EQ(usb_.ask(0x81, 10, 0, 1), Bytes{0});
  EXPECT_EQ(usb_.descriptor(kString, 9, 255), Bytes{}) << "no such text";
  EXPECT_EQ(usb_.tell(0x40, 77, 0), Outcome::kStalled) << "nobody knows this one";
  // An endpoint is halted, and goes on.
  const auto halted = [&](std::uint16_t endpoint) {
    Bytes status;
    EXPECT_EQ(usb_.transfer({0x82, 0, 0, endpoint, 2}, status), Outcome::kDone);
    return status;
  };
  EXPECT_EQ(halted(0x83), (Bytes{0, 0}));
  EXPECT_EQ(usb_.tell(0x02, 3, 0, 0x83), Outcome::kDone);
  EXPECT_EQ(halted(0x83), (Bytes{1, 0}));
  EXPECT_EQ(halted(0x02), (Bytes{0, 0}));
  EXPECT_EQ(usb_.tell(0x02, 1, 0, 0x83), Outcome::kDone);
  EXPECT_EQ(halted(0x83), (Bytes{0, 0}));
  EXPECT_EQ(usb_.tell(0x02, 1, 0, 0x84), Outcome::kStalled) << "no such endpoint";
  EXPECT_EQ(usb_.tell(0x00, 3, 1), Outcome::kStalled) << "wakes no host";
  expect_working_console();
  EXPECT_EQ(usb_.tell(0x00, 9, 0), Outcome::kDone);
  EXPECT_EQ(usb_.ask(0x80, 8, 0, 1), Bytes{0});
  expect_working_console();
  expect_undisturbed();
}

TEST_F(UsbDevice, RemembersTheLineCoding) {
  ASSERT_TRUE(usb_.plug_in());
  EXPECT_EQ(usb_.ask(0xA1, 0x21, 0, 7), (Bytes{0x00, 0xC2, 0x01, 0x00, 0, 0, 8})) << "115200 8N1";
  Bytes coding = {0x80, 0x25, 0, 0, 2, 1, 7};
  ASSERT_EQ(usb_.transfer({0x21, 0x20, 0, 0, 7}, coding), Outcome::kDone);
  EXPECT_EQ(usb_.ask(0xA1, 0x21, 0, 7), coding);
}

// The request says that seven bytes follow, and they never come.
TEST_F(UsbDevice, DoesNotWaitForDataThatNeverCome) {
  ASSERT_TRUE(usb_.plug_in());
  Bytes coding(7);
  usb_.transfer({0x21, 0x20, 0, 0, 7}, coding, Until::kSetup);
  usb_.run_ms(500);
  expect_undisturbed();
  expect_working_console();
}

/// A control transfer that a host breaks off.
struct Broken {
  const char* name;
  UsbRequest request;
  Bytes data;
};

TEST_F(UsbDevice, OutlivesACablePulledAtEveryStageOfATransfer) {
  const Broken transfers[] = {
      {"device descriptor", {0x80, 6, kDevice << 8, 0, 18}, {}},
      {"configuration, two packets", {0x80, 6, kConfiguration << 8, 0, 255}, {}},
      {"address", {0x00, 5, 9, 0, 0}, {}},
      {"configuration", {0x00, 9, 1, 0, 0}, {}},
      {"line coding", {0x21, 0x20, 0, 0, 7}, Bytes(7)},
      {"line state", {0x21, 0x22, 1, 0, 0}, {}},
      {"unknown", {0x40, 77, 0, 0, 0}, {}},
  };
  for (const Broken& it : transfers) {
    for (const Until until : {Until::kSetup, Until::kFirstPacket, Until::kStatus}) {
      SCOPED_TRACE(it.name);
      ASSERT_TRUE(usb_.plug_in());
      Bytes data = it.data;
      usb_.transfer(it.request, data, until);
      usb_.pull_out();
      mcu_.run_ms(130);
      expect_undisturbed();
      expect_working_console();
    }
  }
}

// Without a reset in between: what is left of a transfer must not leak into the next.
TEST_F(UsbDevice, TheNextRequestEndsABrokenOne) {
  ASSERT_TRUE(usb_.plug_in());
  const Bytes device = usb_.descriptor(kDevice, 0, 18);
  for (const Until until : {Until::kSetup, Until::kFirstPacket, Until::kStatus}) {
    Bytes data;
    usb_.transfer({0x80, 6, kConfiguration << 8, 0, 255}, data, until);
    EXPECT_EQ(usb_.descriptor(kDevice, 0, 18), device);
    data.assign(7, 1);
    usb_.transfer({0x21, 0x20, 0, 0, 7}, data, until);
    EXPECT_EQ(usb_.descriptor(kDevice, 0, 18), device);
  }
  expect_undisturbed();
}

TEST_F(UsbDevice, IsSilentUntilAProgramOpensTheLine) {
  ASSERT_TRUE(usb_.plug_in());
  usb_.send("k\n");
  EXPECT_EQ(usb_.listen_ms(100), "");
  expect_working_console();
  ASSERT_TRUE(usb_.set_line(115200, false));
  usb_.send("k\n");
  EXPECT_EQ(usb_.listen_ms(100), "");
}

}  // namespace
}  // namespace screed::mcu
