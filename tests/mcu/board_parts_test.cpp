// The parts of the board around the control loop: USB, console, parameters in EEPROM, reset cause,
// watchdog, stack guard, buttons.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "firmware/parameters/parameter_store.h"
#include "firmware/parameters/parameters.h"
#include "firmware/robot/supervisor.h"
#include "hal/avr/reset_cause.h"
#include "host_sim/devices/mcu/board.h"
#include "schema/class_values.h"
#include "tests/mcu/bench.h"
#include "tests/mcu/ground_lines.h"
#include "tests/mcu/images.h"
#include "tests/mcu/usb_host.h"

extern "C" {
#include <simavr/sim_avr.h>
}

namespace screed::mcu {
namespace {

using avr::ResetCause;

constexpr std::uint8_t kPorf = 1;
constexpr std::uint8_t kExtrf = 2;
constexpr std::uint8_t kBorf = 4;

class BoardParts : public ::testing::Test {
 protected:
  BoardParts() : board_(kScreedImage, read_wiring(kWiring)), mcu_(board_.mcu), usb_(mcu_) {}

  void write_copy(std::uint8_t index, const ParameterCopy& copy) {
    mcu_.write_eeprom(parameter_copy_address(index), copy.bytes);
  }
  ParameterCopy read_copy(std::uint8_t index) const {
    ParameterCopy copy{};
    const std::vector<std::uint8_t> eeprom = mcu_.read_eeprom();
    std::copy_n(eeprom.begin() + parameter_copy_address(index), sizeof(copy.bytes), copy.bytes);
    return copy;
  }

  void open_console() {
    ASSERT_TRUE(usb_.plug_in());
    ASSERT_TRUE(usb_.set_line(115200, true));
    usb_.run_ms(30);
  }
  std::string ask(const std::string& line, double ms = 100) {
    EXPECT_TRUE(usb_.send(line + "\n"));
    return usb_.listen_ms(ms);
  }
  /// The numbers at the end of the answer to "v".
  struct Health {
    int reset_cause = -1;
    int store = -1;
    int stack_free = -1;
    int overruns = -1;
    int buttons = -1;
  };
  Health health() {
    std::istringstream in(ask("v"));
    std::string name;
    std::string version;
    std::string board;
    Health it;
    in >> name >> version >> board >> std::hex >> it.reset_cause >> it.store >> it.stack_free >>
        it.overruns >> it.buttons;
    EXPECT_EQ(name, "screed");
    EXPECT_FALSE(in.fail());
    return it;
  }
  int cause() { return health().reset_cause; }

  Board board_;
  Mcu& mcu_;
  UsbHost usb_;
};

ParameterCopy encoded(const Parameters& parameters, std::uint16_t sequence) {
  ParameterCopy copy{};
  encode_parameters(parameters, sequence, copy);
  return copy;
}

TEST_F(BoardParts, EntersTheBootloaderWhenTheLineIsClosedAt1200Baud) {
  mcu_.run_ms(50);
  ASSERT_TRUE(usb_.plug_in());
  ASSERT_TRUE(usb_.set_line(115200, true));
  ASSERT_TRUE(usb_.set_line(115200, false));
  usb_.run_ms(300);
  EXPECT_EQ(mcu_.starts(), 1) << "closing at another speed is no touch";
  ASSERT_TRUE(usb_.set_line(1200, true));
  usb_.run_ms(300);
  EXPECT_EQ(mcu_.starts(), 1) << "opening is no touch";
  ASSERT_TRUE(usb_.set_line(1200, false));
  usb_.run_ms(20);
  // What the bootloader reads after the watchdog's reset.
  EXPECT_EQ(mcu_.word(0x0800), 0x7777);
  usb_.run_ms(180);
  EXPECT_EQ(mcu_.starts(), 2);
  // Variables lie where the key does, the mark of the cause elsewhere.
  open_console();
  EXPECT_EQ(cause(), static_cast<int>(ResetCause::kUpload));
}

TEST_F(BoardParts, KeepsItsTickWhileAHostDoesNotFetch) {
  mcu_.run_ms(50);
  open_console();
  // The line stays open, the radio's lines are asked for, and nobody fetches them.
  usb_.send("O\n");
  mcu_.clear_load();
  const double begin_ms = mcu_.time_ms();
  usb_.run_ms(1000);
  usb_.pull_out();
  mcu_.run_ms(1000);
  EXPECT_EQ(mcu_.starts(), 1);
  EXPECT_NEAR(static_cast<double>(mcu_.ticks()), (mcu_.time_ms() - begin_ms) / 10, 2);
  EXPECT_LT(mcu_.longest_tick(), kClock_hz / kTickRate_hz + 1500);
}

TEST_F(BoardParts, StoresTheDefaultsAndRestarts) {
  Parameters parameters;
  parameters.climb_threshold() = 750;
  write_copy(0, encoded(parameters, 7));
  mcu_.run_ms(50);
  open_console();
  EXPECT_EQ(ask("d", 1500), "ok\n");
  Parameters stored;
  decode_parameters(read_copy(1), stored);
  EXPECT_EQ(stored.climb_threshold(), Parameters().climb_threshold());
  EXPECT_EQ(copy_sequence(read_copy(1)), 8);
  usb_.send("r\n");
  usb_.pull_out();
  mcu_.run_ms(200);
  EXPECT_EQ(mcu_.starts(), 2);
  open_console();
  EXPECT_EQ(cause(), static_cast<int>(ResetCause::kRequested));
}

// It needs neither a key nor a radio: so it is the robot that has to be sure that nobody is hurt.
TEST(ConsoleMotorTest, TurnsAMotorOfADisarmedRobotWhileButtonAIsHeld) {
  Bench bench;
  bench.ground_station = true;
  bench.run_ms(500);
  UsbHost usb(bench.mcu);
  ASSERT_TRUE(usb.plug_in());
  ASSERT_TRUE(usb.set_line(115200, true));
  const auto hold_button = [&](bool held) { bench.mcu.set_pin({'B', 3}, !held); };
  using Duties = std::pair<int, int>;
  const auto duties_after = [&](const char* order, int ms) {
    if (*order != 0) usb.send(order);
    bench.run_ms(ms);
    return Duties(bench.left_duty(), bench.right_duty());
  };
  hold_button(false);
  EXPECT_EQ(duties_after("ml\n", 100), Duties(0, 0));
  hold_button(true);
  EXPECT_EQ(duties_after("", 100), Duties(80, 0)) << "within the second";
  hold_button(false);
  EXPECT_EQ(duties_after("", 30), Duties(0, 0));
  hold_button(true);
  EXPECT_EQ(duties_after("mr\n", 100), Duties(0, 80));
  EXPECT_EQ(duties_after("", 1000), Duties(0, 0)) << "the second is over";
  for (const char* nonsense : {"m\n", "mx\n", "mll\n"}) {
    EXPECT_EQ(duties_after(nonsense, 100), Duties(0, 0)) << nonsense;
    EXPECT_EQ(usb.listen_ms(50), "?\n") << "nothing more is taken before that is fetched";
  }
  bench.set_parameter(Parameters::k_algorithm,
                      static_cast<std::int16_t>(message::LevelingAlgorithm::kDrive));
  bench.run_ms(5000);
  for (const CommandOp op : {CommandOp::kArm, CommandOp::kRun, CommandOp::kStop}) bench.command(op);
  bench.run_ms(500);
  ASSERT_EQ(message::Heartbeat::unpack(bench.last_frame(kIdHeartbeat).data).state,
            static_cast<uint8_t>(message::HeartbeatState::kStopped));
  EXPECT_EQ(duties_after("ml\n", 100), Duties(0, 0)) << "its controllers are at work";
  bench.accel_z = -4096;
  bench.run_ms(2000);
  ASSERT_EQ(message::Heartbeat::unpack(bench.last_frame(kIdHeartbeat).data).state,
            static_cast<uint8_t>(message::HeartbeatState::kFault));
  bench.accel_z = 4096;
  bench.run_ms(1000);
  EXPECT_EQ(duties_after("ml\n", 100), Duties(0, 0)) << "with a latched fault";
}

TEST_F(BoardParts, RefusesNonsenseOnTheConsole) {
  mcu_.run_ms(50);
  open_console();
  for (const std::string& line : std::vector<std::string>{
           "x", "p", "dd", "w", "v1", "kkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkk"})
    EXPECT_EQ(ask(line), "?\n") << line;
  EXPECT_EQ(check_copy(read_copy(0)), CopyState::kBlank);
}

// As slcand or `screed monitor --port` ask for it. What a cable carries is what the radio carries.
TEST_F(BoardParts, CarriesTheRadiosLinesByUsb) {
  mcu_.run_ms(50);
  open_console();
  EXPECT_EQ(usb_.listen_ms(300), "") << "nobody has asked";
  usb_.send("\rC\rS6\rO\r");
  usb_.listen_ms(100);
  const auto before = static_cast<std::ptrdiff_t>(mcu_.sent().size());
  const std::string by_cable = usb_.listen_ms(1000);
  const std::vector<std::uint8_t> by_radio(mcu_.sent().begin() + before, mcu_.sent().end());
  const std::vector<CanFrame> frames = frames_in({by_cable.begin(), by_cable.end()});
  const std::vector<CanFrame> sent = frames_in(by_radio);
  ASSERT_GT(frames.size(), 80U);
  EXPECT_NEAR(static_cast<double>(frames.size()), static_cast<double>(sent.size()), 6.0);
  const auto same = std::search(sent.begin(), sent.end(), frames.begin() + 8, frames.begin() + 40,
                                [](const CanFrame& a, const CanFrame& b) {
                                  return a.id == b.id && std::equal(a.data, a.data + 8, b.data);
                                });
  EXPECT_NE(same, sent.end()) << "the same ones in the same order";
  usb_.send("C\r");
  usb_.listen_ms(100);
  EXPECT_EQ(usb_.listen_ms(300), "");
}

TEST_F(BoardParts, TakesALineByUsbAsOneOfTheRadio) {
  mcu_.run_ms(50);
  open_console();
  GroundLines ground;
  for (int i = 0; i < 5; ++i) {
    const std::vector<std::uint8_t> line = ground.heartbeat(static_cast<std::uint32_t>(i) * 200);
    usb_.send(std::string(line.begin(), line.end()));
    usb_.listen_ms(200);
  }
  const std::vector<CanFrame> frames = frames_in(mcu_.sent());
  const auto alive = std::find_if(frames.rbegin(), frames.rend(),
                                  [](const CanFrame& it) { return it.id == kIdHeartbeat; });
  ASSERT_NE(alive, frames.rend());
  EXPECT_EQ(message::Heartbeat::unpack(alive->data).link_alive, 1);
  EXPECT_EQ(ask("k"), "k 00 FF 0001\n") << "the console goes on";
}

TEST_F(BoardParts, StoredParametersAreInForce) {
  Parameters parameters;
  parameters.algorithm() = 2;
  write_copy(1, encoded(parameters, 5));
  parameters.algorithm() = 0;
  write_copy(0, encoded(parameters, 4));
  mcu_.run_ms(300);
  const std::vector<CanFrame> frames = frames_in(mcu_.sent());
  const auto leveling = std::find_if(frames.begin(), frames.end(),
                                     [](const CanFrame& it) { return it.id == kIdLeveling; });
  ASSERT_NE(leveling, frames.end());
  EXPECT_EQ(leveling->data[2], 2);
}

TEST_F(BoardParts, WithoutAGoodCopyItRefusesToBeArmed) {
  ParameterCopy bad = encoded(Parameters(), 5);
  bad.bytes[9] ^= 0x04;
  write_copy(0, bad);
  write_copy(1, bad);
  mcu_.write_eeprom(kCredentialRecordAddress, credential_record(credentials_of(test_key())).bytes);
  GroundLines ground;
  for (int i = 0; i < 60; ++i) {
    board_.set_acceleration(0.244 * Eigen::Vector3d(i % 3, 0, 4096));
    board_.set_angular_rate(0.070 * Eigen::Vector3d(i % 3 - 1, 0, i % 2));
    mcu_.receive(ground.heartbeat(static_cast<std::uint32_t>(i) * 100));
    mcu_.run_ms(100);
  }
  mcu_.receive(ground.command(CommandOp::kArm));
  mcu_.run_ms(100);
  const std::vector<CanFrame> frames = frames_in(mcu_.sent());
  const auto answer = std::find_if(frames.begin(), frames.end(),
                                   [](const CanFrame& it) { return it.id == kIdCommandAck; });
  ASSERT_NE(answer, frames.end());
  EXPECT_EQ(static_cast<RequestResult>(answer->data[4]), RequestResult::kFaultPresent);
}

TEST_F(BoardParts, TakesAKeyOverUsbForTheNextStart) {
  mcu_.run_ms(100);
  open_console();
  EXPECT_EQ(ask("k"), "k 00 FF 0001\n") << "an erased EEPROM";
  EXPECT_EQ(ask("k00"), "?\n");
  EXPECT_EQ(ask("k000102030405060708090A0B0C0D0E0FG1"), "?\n");
  EXPECT_EQ(ask("k000102030405060708090a0B0C0D0E0F01", 600), "ok\n");
  EXPECT_EQ(ask("k"), "k 00 FF 0001\n") << "not yet, and never shown";
  const std::vector<std::uint8_t> eeprom = mcu_.read_eeprom();
  CredentialRecord record{};
  std::copy_n(eeprom.begin() + kCredentialRecordAddress, kCredentialRecordSize, record.bytes);
  Credentials next{};
  EXPECT_TRUE(begin_start(record, next));
  EXPECT_TRUE(next.key_set);
  EXPECT_EQ(command_key_of(next), test_key());
  EXPECT_EQ(next.boot_epoch, kFirstBootEpoch);
}

TEST_F(BoardParts, EveryStartHasItsNumber) {
  mcu_.write_eeprom(kCredentialRecordAddress, credential_record(credentials_of(test_key())).bytes);
  for (int start = 0; start < 5; ++start) {
    mcu_.run_ms(300);
    const std::vector<CanFrame> frames = frames_in(mcu_.sent());
    const auto last = std::find_if(frames.rbegin(), frames.rend(),
                                   [](const CanFrame& it) { return it.id == kIdHeartbeat; });
    ASSERT_NE(last, frames.rend());
    EXPECT_EQ(message::Heartbeat::unpack(last->data).boot_epoch, kFirstBootEpoch + start);
    mcu_.reset(0);
  }
}

TEST_F(BoardParts, KnowsWhyItStarted) {
  mcu_.run_ms(100);
  open_console();
  EXPECT_EQ(cause(), static_cast<int>(ResetCause::kPowerOn)) << "RAM without a mark";
  // What the bootloaders leave in MCUSR: Pololu's A-Star BORF only, Arduino's nothing.
  const struct {
    std::uint8_t flags;
    ResetCause cause;
  } cases[] = {{kBorf, ResetCause::kBrownOut},
               {0, ResetCause::kExternal},
               {kExtrf, ResetCause::kExternal},
               {kPorf, ResetCause::kPowerOn},
               {kPorf | kBorf, ResetCause::kPowerOn}};
  for (const auto& it : cases) {
    mcu_.reset(it.flags);
    mcu_.run_ms(100);
    open_console();
    EXPECT_EQ(cause(), static_cast<int>(it.cause)) << "MCUSR " << int{it.flags};
  }
}

TEST_F(BoardParts, ABrownOutIsNoneWhenRamWasLostAsWell) {
  mcu_.run_ms(100);
  // The supply rises slowly: BORF, which the bootloader leaves, and RAM as it comes.
  for (std::uint16_t at = kRamBegin; at < kRamEnd; ++at) mcu_.simulator()->data[at] = 0x5A;
  mcu_.reset(kBorf);
  mcu_.run_ms(100);
  open_console();
  EXPECT_EQ(cause(), static_cast<int>(ResetCause::kPowerOn));
}

TEST_F(BoardParts, AMainLoopThatComesBackLeavesNoMarkOfTheWatchdog) {
  mcu_.run_ms(100);
  avr_t* const avr = mcu_.simulator();
  const std::vector<std::uint8_t> flash(avr->flash, avr->flash + 4 * kVectors);
  mcu_.break_tick();
  mcu_.run_ms(90);
  std::copy(flash.begin(), flash.end(), avr->flash);
  mcu_.run_ms(100);
  ASSERT_EQ(mcu_.starts(), 1) << "the watchdog was in time";
  mcu_.reset(kExtrf);
  mcu_.run_ms(100);
  open_console();
  EXPECT_EQ(cause(), static_cast<int>(ResetCause::kExternal));
}

TEST_F(BoardParts, TheWatchdogResetsAHungProgram) {
  mcu_.run_ms(100);
  mcu_.break_tick();
  mcu_.run_ms(200);
  EXPECT_GE(mcu_.starts(), 2);
}

TEST_F(BoardParts, TheWatchdogResetsAProgramThatHangsWithItsInterruptsOff) {
  mcu_.run_ms(100);
  // Timer 3's handler: cli, then a jump to itself.
  avr_t* const avr = mcu_.simulator();
  const std::uint8_t hang[] = {0xF8, 0x94, 0xFF, 0xCF};
  std::copy(std::begin(hang), std::end(hang), avr->flash + kTimer3CompaVector * 4);
  mcu_.run_ms(140);
  EXPECT_EQ(mcu_.starts(), 2);
}

TEST_F(BoardParts, StopsWhenTheStackReachesTheVariables) {
  mcu_.run_ms(100);
  open_console();
  // The canary: the first byte behind the variables is the lowest painted one.
  std::uint16_t heap = kRamBegin;
  while (heap < kRamEnd && mcu_.word(heap) != 0xA5A5) ++heap;
  ASSERT_LT(heap, kRamEnd - 256) << "as much is free, stack apart";
  mcu_.simulator()->data[heap] = 0;
  usb_.run_ms(200);
  EXPECT_EQ(mcu_.starts(), 2);
  open_console();
  EXPECT_EQ(cause(), static_cast<int>(ResetCause::kStack));
}

TEST_F(BoardParts, ReportsFreeStack) {
  mcu_.run_ms(4000);
  open_console();
  const Health it = health();
  EXPECT_GT(it.stack_free, 256);
  EXPECT_LT(it.stack_free, 2560);
  EXPECT_EQ(it.overruns, 0);
}

TEST_F(BoardParts, ReadsButtonsThatShareTheirPinsWithLeds) {
  const PinName pins[] = {{'B', 3}, {'D', 5}, {'B', 0}};
  for (const PinName pin : pins) mcu_.set_pin(pin, true);
  mcu_.run_ms(100);
  open_console();
  EXPECT_EQ(health().buttons, 0);
  for (int i = 0; i < 3; ++i) {
    mcu_.set_pin(pins[i], false);
    EXPECT_EQ(health().buttons, 1 << i);
    mcu_.set_pin(pins[i], true);
  }
}

}  // namespace
}  // namespace screed::mcu
