// Finding the board and its bootloader in a made-up sysfs, with a clock that only this test moves.
#include "tools/flash/board_port.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "tests/flash/fake_usb.h"
#include "tools/flash/serial_touch.h"

namespace screed::flash {
namespace {

using std::chrono::milliseconds;

constexpr UsbId kSketch{0x1FFB, 0x2300};
constexpr UsbId kBootloader{0x1FFB, 0x0101};
constexpr UsbId kOther{0x0403, 0x6001};
constexpr BoardUsb kBoard{kSketch, kBootloader};

/// The message of the `Error` that `action` throws.
template <class Error, class Action>
std::string message_of(Action action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "(no such error)";
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

/// A clock that stands still but for its pauses; `happen` is what the world does in them.
struct World {
  milliseconds now{0};
  std::function<void()> on_pause = [] {};
  std::vector<std::string> told;

  std::filesystem::path bootloader(const BoardPort& board, const FakeUsb& usb) {
    const Clock clock{[this] { return now; },
                      [this](milliseconds duration) {
                        now += duration;
                        on_pause();
                      }};
    return bootloader_port(board, usb.roots(), kBoard, Timeouts{}, clock,
                           [this](const std::string& line) { told.push_back(line); });
  }
};

TEST(UsbId, IsReadAndWrittenAsLsusbDoes) {
  EXPECT_EQ(to_string(UsbId{0x1FFB, 0x0101}), "1ffb:0101");
  EXPECT_EQ(parse_usb_id("1FFB:2300"), kSketch);
  for (const char* wrong : {"", "1ffb", "1ffb:230", "1ffb:23000", "0x1ffb:2300", "1ffb-2300"})
    EXPECT_THROW(parse_usb_id(wrong), InputError) << wrong;
}

TEST(UsbSerialPorts, AreThoseOnUsbInOrder) {
  FakeUsb usb;
  usb.plug_in("1-2", kOther, "ttyUSB0", {}, "FT232R");
  usb.plug_in("1-1.4", kSketch, "ttyACM3");
  const auto ports = usb_serial_ports(usb.roots());
  ASSERT_EQ(ports.size(), 2U);
  EXPECT_EQ(ports[0].device, usb.device("ttyACM3"));
  EXPECT_EQ(ports[0].socket, "1-1.4");
  EXPECT_EQ(ports[0].id, kSketch);
  EXPECT_EQ(to_string(ports[1]), usb.device("ttyUSB0").string() + " (USB 0403:6001, FT232R)");
}

TEST(UsbSerialPorts, AMachineWithoutSerialPortsHasNone) {
  EXPECT_TRUE(usb_serial_ports({"/nowhere", "/nowhere"}).empty());
}

TEST(FindBoard, TakesTheOnlyOne) {
  FakeUsb usb;
  usb.plug_in("1-2", kOther, "ttyUSB0");
  usb.plug_in("1-1", kSketch, "ttyACM0");
  const auto board = find_board(usb.roots(), kBoard, "");
  EXPECT_EQ(board.device, usb.device("ttyACM0"));
  EXPECT_EQ(board.socket, "1-1");
  EXPECT_FALSE(board.in_bootloader);
}

TEST(FindBoard, KnowsABootloader) {
  FakeUsb usb;
  usb.plug_in("1-1", kBootloader, "ttyACM0");
  EXPECT_TRUE(find_board(usb.roots(), kBoard, "").in_bootloader);
}

TEST(FindBoard, WithoutABoardSaysWhatWasLookedFor) {
  FakeUsb usb;
  usb.plug_in("1-2", kOther, "ttyUSB0");
  const auto message = message_of<RunError>([&] { find_board(usb.roots(), kBoard, ""); });
  EXPECT_TRUE(contains(message, "no board found")) << message;
  EXPECT_TRUE(contains(message, "1ffb:2300")) << message;
  EXPECT_TRUE(contains(message, "1ffb:0101")) << message;
  EXPECT_TRUE(contains(message, "ttyUSB0 (USB 0403:6001)")) << message;
  EXPECT_FALSE(contains(message, "\n")) << message;
}

TEST(FindBoard, WithSeveralBoardsListsThem) {
  FakeUsb usb;
  usb.plug_in("1-1", kSketch, "ttyACM0");
  usb.plug_in("1-2", kBootloader, "ttyACM1");
  usb.plug_in("1-3", kOther, "ttyUSB0");
  const auto message = message_of<RunError>([&] { find_board(usb.roots(), kBoard, ""); });
  EXPECT_TRUE(contains(message, "PORT=")) << message;
  EXPECT_TRUE(contains(message, "ttyACM0 (USB 1ffb:2300), ")) << message;
  EXPECT_TRUE(contains(message, "ttyACM1 (USB 1ffb:0101)")) << message;
  EXPECT_FALSE(contains(message, "ttyUSB0")) << message;
}

TEST(FindBoard, TakesTheOneAskedForUnderAnyName) {
  FakeUsb usb;
  const SketchPort first;
  const SketchPort second;
  usb.plug_in("1-1", kSketch, "ttyACM0", first.port());
  usb.plug_in("1-2", kSketch, "ttyACM1", second.port());
  const auto link = usb.folder() / "by-id";
  std::filesystem::create_symlink(usb.device("ttyACM1"), link);
  EXPECT_EQ(find_board(usb.roots(), kBoard, link).socket, "1-2");
}

TEST(FindBoard, RefusesAnotherDevice) {
  FakeUsb usb;
  const SketchPort radio;
  usb.plug_in("1-2", kOther, "ttyUSB0", radio.port());
  const auto message =
      message_of<InputError>([&] { find_board(usb.roots(), kBoard, usb.device("ttyUSB0")); });
  EXPECT_TRUE(contains(message, "0403:6001")) << message;
  EXPECT_TRUE(contains(message, "not the board")) << message;
}

TEST(FindBoard, NamesAPortThatDoesNotExist) {
  FakeUsb usb;
  const auto message =
      message_of<InputError>([&] { find_board(usb.roots(), kBoard, "/dev/ttyACM77"); });
  EXPECT_TRUE(contains(message, "PORT=/dev/ttyACM77 does not exist")) << message;
}

TEST(FindBoard, TakesAPortThatIsNotOnUsbForABootloader) {
  FakeUsb usb;
  const SketchPort pty;
  EXPECT_TRUE(find_board(usb.roots(), kBoard, pty.port()).in_bootloader);
}

TEST(Touch, OpensAt1200BaudAndCloses) {
  const SketchPort sketch;
  EXPECT_FALSE(sketch.touched());
  const int keeper = open(sketch.port().c_str(), O_RDWR | O_NOCTTY);
  touch_at_1200_baud(sketch.port());
  EXPECT_FALSE(sketch.touched());  // a port that stays open is not closed yet: the fake can tell
  close(keeper);
  EXPECT_TRUE(sketch.touched());
}

TEST(Touch, APortThatVanishedIsNoError) {
  touch_at_1200_baud("/dev/no_such_port");
}

TEST(Bootloader, ComesBackUnderAnotherName) {
  FakeUsb usb;
  const SketchPort sketch;
  const SketchPort bootloader;
  usb.plug_in("1-1", kSketch, "ttyACM0", sketch.port());
  usb.plug_in("1-2", kBootloader, "ttyACM1", sketch.port());  // of another robot
  World world;
  world.on_pause = [&] {
    if (!sketch.touched()) return;
    if (world.now == milliseconds(200)) usb.unplug("1-1", "ttyACM0");
    if (world.now == milliseconds(1500))
      usb.plug_in("1-1", kBootloader, "ttyACM2", bootloader.port());
  };
  const auto board = find_board(usb.roots(), kBoard, usb.device("ttyACM0"));
  EXPECT_EQ(world.bootloader(board, usb), usb.device("ttyACM2"));
  EXPECT_EQ(world.now, milliseconds(1500));
  EXPECT_EQ(world.told.size(), 1U);
}

TEST(Bootloader, ComesBackUnderTheSameName) {
  FakeUsb usb;
  const SketchPort sketch;
  const SketchPort bootloader;
  usb.plug_in("1-1", kSketch, "ttyACM0", sketch.port());
  World world;
  world.on_pause = [&] {
    if (!sketch.touched() || world.now != milliseconds(800)) return;
    usb.unplug("1-1", "ttyACM0");
    usb.plug_in("1-1", kBootloader, "ttyACM0", bootloader.port());
  };
  EXPECT_EQ(world.bootloader(find_board(usb.roots(), kBoard, ""), usb), usb.device("ttyACM0"));
}

TEST(Bootloader, IsTouchedForAgainWhenItDoesNotCome) {
  FakeUsb usb;
  const SketchPort sketch;
  const SketchPort bootloader;
  usb.plug_in("1-1", kSketch, "ttyACM0", sketch.port());
  World world;
  world.on_pause = [&] {
    if (world.told.size() == 1 && world.now == milliseconds(1000)) {  // only restarts its sketch
      usb.unplug("1-1", "ttyACM0");
      usb.plug_in("1-1", kSketch, "ttyACM5", sketch.port());
    }
    if (world.told.size() == 2 && world.now == milliseconds(6000)) {
      usb.unplug("1-1", "ttyACM5");
      usb.plug_in("1-1", kBootloader, "ttyACM6", bootloader.port());
    }
  };
  EXPECT_EQ(world.bootloader(find_board(usb.roots(), kBoard, ""), usb), usb.device("ttyACM6"));
  ASSERT_EQ(world.told.size(), 2U);
  EXPECT_TRUE(contains(world.told[1], "ttyACM5")) << world.told[1];
}

TEST(Bootloader, ThatNeverComesEndsAfterThreeTouches) {
  FakeUsb usb;
  const SketchPort sketch;
  usb.plug_in("1-1", kSketch, "ttyACM0", sketch.port());
  World world;
  const auto board = find_board(usb.roots(), kBoard, "");
  const auto message = message_of<RunError>([&] { world.bootloader(board, usb); });
  EXPECT_TRUE(contains(message, "no bootloader")) << message;
  EXPECT_TRUE(contains(message, "3 times")) << message;
  EXPECT_TRUE(contains(message, "reset button twice")) << message;
  EXPECT_EQ(world.told.size(), 3U);
  EXPECT_EQ(world.now, milliseconds(15000));
}

TEST(Bootloader, ThatRunsAlreadyIsLeftAlone) {
  FakeUsb usb;
  const SketchPort bootloader;
  usb.plug_in("1-1", kBootloader, "ttyACM0", bootloader.port());
  World world;
  EXPECT_EQ(world.bootloader(find_board(usb.roots(), kBoard, ""), usb), usb.device("ttyACM0"));
  EXPECT_FALSE(bootloader.touched());
  EXPECT_EQ(world.now, milliseconds(0));
}

}  // namespace
}  // namespace screed::flash
