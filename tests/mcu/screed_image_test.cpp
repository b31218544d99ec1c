// The image that is flashed, on a simulated board: it boots, keeps its tick, reads its devices,
// drives, and stays safe when devices fail.
#include <gtest/gtest.h>
#include <simavr/sim_avr.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include "firmware/robot/supervisor.h"
#include "schema/class_values.h"
#include "tests/mcu/bench.h"
#include "tests/mcu/images.h"
#include "tests/mcu/usb_host.h"
#include "tools/avr/stack/disassembly.h"

namespace screed::mcu {
namespace {

constexpr std::uint16_t kPinB = 0x23;
constexpr std::uint64_t kMsCycles = kClock_hz / 1000;
constexpr std::uint64_t kTickCycles = kClock_hz / kTickRate_hz;
// Half of the tick is the most a tick may take, interrupts included.
constexpr std::uint64_t kMaxBusyCycles = kTickCycles / 2;

void expect_healthy(const Bench& bench) {
  EXPECT_TRUE(bench.mcu.alive());
  EXPECT_EQ(bench.mcu.starts(), 1) << "the MCU was reset";
  // An interrupt that runs already, or one atomic block, may delay the tick.
  EXPECT_GT(bench.mcu.shortest_tick(), kTickCycles - 600);
  EXPECT_LT(bench.mcu.longest_tick(), kTickCycles + 600);
  EXPECT_LE(bench.mcu.busiest_tick_cycles(), kMaxBusyCycles);
  EXPECT_LE(bench.mcu.stack_used(), computed_stack());
}

RobotState state_of(const CanFrame& heartbeat) {
  return static_cast<RobotState>(message::Heartbeat::unpack(heartbeat.data).state);
}

std::int16_t value_at(const CanFrame& frame, std::size_t index) {
  return get_s16(&frame.data[kE2eHeaderSize + 2 * index]);
}

/// Runs on to where the next tick has just begun.
void begin_tick(Bench& bench) {
  const std::uint64_t now = bench.mcu.ticks();
  while (bench.mcu.ticks() == now) bench.mcu.run_ms(0.01);
}

/// Armed and driving straight on.
void set_off(Bench& bench) {
  bench.ground_station = true;
  bench.run_ms(6000);  // the estimator averages gravity and finds the bias of the gyro first
  bench.command(CommandOp::kArm);
  bench.command(CommandOp::kRun);
  bench.run_ms(300);
  ASSERT_EQ(state_of(bench.last_frame(kIdHeartbeat)), RobotState::kRunning);
}

TEST(ScreedImage, TicksAndTalksWithoutAnyDevice) {
  Bench bench;
  bench.accel_mag.present = bench.gyro.present = bench.baro.present = false;
  bench.run_ms(3000);
  expect_healthy(bench);
  EXPECT_NEAR(static_cast<double>(bench.mcu.ticks()), 299, 2);
  EXPECT_NEAR(static_cast<double>(bench.frames(kIdHeartbeat).size()), 15, 1);
  EXPECT_EQ(bench.mcu.word(kOcr1a), 0);
  EXPECT_EQ(bench.mcu.word(kOcr1b), 0);
}

// simavr sleeps on past an end that falls on the cycle in which the program falls asleep: what the
// world does then, as an encoder's edge, would come up to 5 ms late.
TEST(ScreedImage, RunsToAnyCycleAndNotPastIt) {
  Bench bench;
  bench.run_ms(100);
  std::uint64_t furthest = 0;
  std::uint64_t target = bench.mcu.cycle();
  for (int i = 0; i < 400'000; ++i) {
    target += 37;
    bench.mcu.run_to(target);
    if (bench.mcu.cycle() > target) furthest = std::max(furthest, bench.mcu.cycle() - target);
  }
  // An instruction of four cycles, or the response to an interrupt out of sleep.
  EXPECT_LT(furthest, 20U);
}

// The watchdog resets 16 ms after it was told to, in simavr up to 120: as long as that the motors
// have none of the duty that they had.
TEST(ScreedImage, ARestartFromTheConsoleStopsTheMotorsFirst) {
  Bench bench;
  UsbHost usb(bench.mcu);
  bench.run_ms(50);
  ASSERT_TRUE(usb.plug_in());
  ASSERT_TRUE(usb.set_line(115200, true));
  set_off(bench);
  ASSERT_GT(bench.left_duty(), 0);
  ASSERT_TRUE(usb.send("r\n"));
  double off_ms = 0.0;  // since when
  for (int i = 0; i < 2000 && bench.mcu.starts() == 1; ++i) {
    if (bench.left_duty() != 0 || bench.right_duty() != 0) off_ms = bench.mcu.time_ms();
    bench.mcu.run_ms(0.1);
  }
  EXPECT_EQ(bench.mcu.starts(), 2);
  EXPECT_GT(bench.mcu.time_ms() - off_ms, 10.0);
  bench.run_ms(1000);
  EXPECT_EQ(bench.left_duty(), 0);
  EXPECT_EQ(bench.right_duty(), 0);
  EXPECT_EQ(state_of(bench.last_frame(kIdHeartbeat)), RobotState::kDisarmed);
}

TEST(ScreedImage, ConfiguresAndReadsTheSensors) {
  Bench bench;
  bench.run_ms(1000);
  EXPECT_EQ(bench.accel_mag.register_value(0x20), 0x7F);
  EXPECT_EQ(bench.accel_mag.register_value(0x21), 0xD8);
  EXPECT_EQ(bench.accel_mag.register_value(0x24), 0x74);
  EXPECT_EQ(bench.accel_mag.register_value(0x25), 0x20);
  EXPECT_EQ(bench.accel_mag.register_value(0x26), 0x00);
  EXPECT_EQ(bench.gyro.register_value(0x20), 0x7F);
  EXPECT_EQ(bench.gyro.register_value(0x23), 0xA0);
  EXPECT_EQ(bench.baro.register_value(0x20), 0xC4);
  const CanFrame accel = bench.last_frame(kIdAccelRaw);
  EXPECT_NEAR(value_at(accel, 2), 4096, 3);
  EXPECT_EQ(value_at(bench.last_frame(kIdMagRaw), 1), 1250);
  bench.run_ms(1500);
  const CanFrame baro = bench.last_frame(kIdBaro);
  EXPECT_EQ(get_u16(baro.data + 2) | (baro.data[4] << 16), 0x3F5678 >> 4);
  EXPECT_EQ(value_at(baro, 2), 0xD8DC - 0x10000);
  expect_healthy(bench);
}

TEST(ScreedImage, WritesNothingToSensorsThatAreRight) {
  Bench bench;
  bench.run_ms(1000);
  bench.gyro.written.clear();
  bench.accel_mag.written.clear();
  bench.run_ms(1000);
  EXPECT_TRUE(bench.gyro.written.empty());
  EXPECT_TRUE(bench.accel_mag.written.empty());
}

TEST(ScreedImage, ConfiguresASensorAgainAfterABrownOut) {
  Bench bench;
  bench.run_ms(1000);
  bench.gyro.power_up();
  bench.run_ms(400);
  EXPECT_EQ(bench.gyro.register_value(0x20), 0x7F);
  EXPECT_EQ(bench.gyro.register_value(0x23), 0xA0);
  expect_healthy(bench);
}

TEST(ScreedImage, StopsWhenASensorVanishesWhileDriving) {
  for (const bool gyro : {true, false}) {
    Bench bench;
    set_off(bench);
    EXPECT_GT(bench.mcu.word(kOcr1a) + bench.mcu.word(kOcr1b), 0);
    (gyro ? bench.gyro.present : bench.accel_mag.present) = false;
    bench.run_ms(100);
    EXPECT_EQ(bench.mcu.word(kOcr1a), 0);
    EXPECT_EQ(bench.mcu.word(kOcr1b), 0);
    bench.run_ms(200);
    const CanFrame heartbeat = bench.last_frame(kIdHeartbeat);
    EXPECT_EQ(state_of(heartbeat), RobotState::kFault);
    EXPECT_NE(get_u16(heartbeat.data + 2) & Fault::kImuSilent, 0);
    expect_healthy(bench);
  }
}

TEST(ScreedImage, KeepsItsTickWhileTheBusHangs) {
  Bench bench;
  set_off(bench);
  bench.frames(kIdHeartbeat);
  bench.board.bus.hold_data();
  bench.run_ms(100);
  EXPECT_EQ(bench.mcu.word(kOcr1a), 0);
  EXPECT_EQ(bench.mcu.word(kOcr1b), 0);
  bench.run_ms(900);
  EXPECT_EQ(bench.frames(kIdHeartbeat).size(), 5U);
  expect_healthy(bench);
}

TEST(ScreedImage, FreesAHangingBusWithNineClocks) {
  Bench bench;
  set_off(bench);
  const unsigned before = bench.board.bus.clock_pulses();
  bench.board.bus.hold_data(9);  // a device in the middle of a byte lets go at the ninth clock
  bench.run_ms(25);
  EXPECT_FALSE(bench.board.bus.data_held());
  EXPECT_EQ(bench.board.bus.clock_pulses() - before, 9U + 1U) << "nine clocks and a stop condition";
  const unsigned reads = bench.gyro.reads;
  bench.run_ms(300);
  EXPECT_GT(bench.gyro.reads, reads + 150) << "the bus was not freed";
  EXPECT_GT(bench.mcu.word(kOcr1a) + bench.mcu.word(kOcr1b), 0) << "no reason to stop";
  expect_healthy(bench);
}

TEST(ScreedImage, CountsEveryEncoderEdge) {
  Bench bench;
  bench.run_ms(300);
  const CanFrame before = bench.last_frame(kIdEncoders);
  // Three times the fastest: 0.75 m/s of 565.5 um a count are 1326 counts/s on each track; 1400
  // here.
  for (int i = 0; i < 1400; ++i) {
    bench.turn_left_encoder(true);
    bench.mcu.run_ms(0.31);
    bench.turn_right_encoder(false);
    bench.mcu.run_ms(0.40);
  }
  bench.run_ms(100);
  const CanFrame after = bench.last_frame(kIdEncoders);
  EXPECT_EQ(static_cast<std::int16_t>(value_at(after, 0) - value_at(before, 0)), 1400);
  EXPECT_EQ(static_cast<std::int16_t>(value_at(after, 1) - value_at(before, 1)), -1400);
  EXPECT_EQ(bench.last_frame(kIdMotors).data[6], 0) << "missed edges";
  // Both channels between two instructions: an edge was missed.
  bench.mcu.set_pin({'B', 4}, true);
  bench.mcu.set_pin({'B', 7}, true);
  bench.run_ms(100);
  EXPECT_EQ(bench.last_frame(kIdMotors).data[6], 1);
  expect_healthy(bench);
}

// A wire that picks up a radio: an edge every 10 us would leave the main loop no time.
TEST(ScreedImage, SurvivesAFloodOfEncoderEdges) {
  Bench bench;
  bench.run_ms(300);
  for (int i = 0; i < 50'000; ++i) {
    bench.mcu.set_pin({'B', 4}, i % 2 == 0);
    bench.mcu.run_ms(0.01);
  }
  EXPECT_EQ(bench.mcu.starts(), 1) << "the watchdog";
  EXPECT_LT(bench.mcu.longest_tick(), kTickCycles + 600);
  EXPECT_LE(bench.mcu.busiest_tick_cycles(), kMaxBusyCycles);
  bench.run_ms(100);
  EXPECT_GT(bench.last_frame(kIdMotors).data[6], 20) << "floods count as errors";
  // And it counts on.
  const CanFrame before = bench.last_frame(kIdEncoders);
  for (int i = 0; i < 100; ++i) {
    bench.turn_right_encoder(true);
    bench.mcu.run_ms(1);
  }
  bench.run_ms(100);
  EXPECT_EQ(
      static_cast<std::int16_t>(value_at(bench.last_frame(kIdEncoders), 1) - value_at(before, 1)),
      100);
}

// Deaf until the end of the tick, it counts on from the levels that it finds then: what has changed
// meanwhile is lost, and neither a step nor an error.
TEST(ScreedImage, AfterAFloodItCountsFromThePresentLevels) {
  Bench bench;
  bench.run_ms(300);
  begin_tick(bench);
  bench.mcu.run_ms(3.0);
  const CanFrame before = bench.last_frame(kIdEncoders);
  const int errors = bench.last_frame(kIdMotors).data[6];
  const bool high = (bench.mcu.memory(kPinB) & 1U << 4U) != 0;
  for (int i = 0; i < 100; ++i) {  // back where it was
    bench.mcu.set_pin({'B', 4}, (i % 2 == 0) != high);
    bench.mcu.run_ms(0.04);
  }
  bench.turn_left_encoder(true);
  bench.turn_right_encoder(true);
  begin_tick(bench);
  bench.mcu.run_ms(3.0);
  for (int i = 0; i < 3; ++i) {
    bench.turn_left_encoder(true);
    bench.turn_right_encoder(true);
    bench.mcu.run_ms(1.0);
  }
  bench.run_ms(100);
  const CanFrame after = bench.last_frame(kIdEncoders);
  EXPECT_EQ(static_cast<std::int16_t>(value_at(after, 0) - value_at(before, 0)), 3);
  EXPECT_EQ(static_cast<std::int16_t>(value_at(after, 1) - value_at(before, 1)), 3);
  EXPECT_EQ(bench.last_frame(kIdMotors).data[6], errors + 1) << "the flood alone";
}

TEST(ScreedImage, DrivesAndStopsWithTheLink) {
  Bench bench;
  set_off(bench);
  EXPECT_GT(bench.mcu.word(kOcr1a) + bench.mcu.word(kOcr1b), 0);
  // As soon as it is heard: the duty changes by some 10 a tick.
  const CanFrame before = bench.last_frame(kIdMotors);
  for (int ms = 0; ms < 200 && bench.last_frame(kIdMotors).data[1] == before.data[1]; ++ms)
    bench.run_ms(1);
  EXPECT_NEAR(bench.left_duty(), value_at(bench.last_frame(kIdMotors), 0), 40);
  // The image's own measure of its load, in percent: from the tick to the end of its computation.
  const double busy = 100.0 * static_cast<double>(bench.mcu.busiest_tick_cycles()) / kTickCycles;
  EXPECT_LE(bench.last_frame(kIdPower).data[4], busy);
  EXPECT_GT(bench.last_frame(kIdPower).data[4] + 1, busy / 2);  // whole per cents, rounded down
  expect_healthy(bench);
  bench.ground_station = false;
  bench.run_ms(2000);
  EXPECT_EQ(bench.mcu.word(kOcr1a), 0);
  EXPECT_EQ(bench.mcu.word(kOcr1b), 0);
  EXPECT_EQ(state_of(bench.last_frame(kIdHeartbeat)), RobotState::kDisarmed);
  std::printf("busiest tick: %llu cycles of %llu; stack: %u B measured, %u B computed\n",
              static_cast<unsigned long long>(bench.mcu.busiest_tick_cycles()),
              static_cast<unsigned long long>(kTickCycles), bench.mcu.stack_used(),
              computed_stack());
}

/// Watches a direction pin: the duty register at the moment it changes.
struct DirectionWatch {
  Bench& bench;
  std::uint16_t duty_register;
  int changes = 0;
  int changes_under_power = 0;
};

TEST(ScreedImage, ReversesAMotorOnlyWithoutDuty) {
  Bench bench;
  DirectionWatch left{bench, kOcr1a};
  DirectionWatch right{bench, kOcr1b};
  const auto watch = [](DirectionWatch& it) {
    return [&it](bool) {
      ++it.changes;
      if (it.bench.mcu.word(it.duty_register) != 0) ++it.changes_under_power;
    };
  };
  // As the ground station says: of the other algorithms a robot that the world pushes may be stuck.
  bench.ground_station = true;
  bench.run_ms(500);
  bench.set_parameter(Parameters::k_algorithm,
                      static_cast<std::int16_t>(message::LevelingAlgorithm::kDrive));
  set_off(bench);
  bench.command(CommandOp::kDrive, {100, 0});
  bench.run_ms(500);
  bench.mcu.watch_pin({'D', 6}, watch(left));
  bench.mcu.watch_pin({'E', 2}, watch(right));
  // Downhill: the motors have to brake. For long no slope pushes so.
  bench.tracks_pushed_mm_per_s = 300;
  bench.run_ms(120);
  EXPECT_LT(bench.left_duty(), 0);
  EXPECT_LT(bench.right_duty(), 0);
  EXPECT_LT(value_at(bench.last_frame(kIdMotors), 0), 0);
  bench.tracks_pushed_mm_per_s = 0;
  bench.run_ms(300);
  bench.tracks_pushed_mm_per_s = -300;
  bench.run_ms(120);
  EXPECT_GT(bench.left_duty(), 0);
  EXPECT_GT(bench.right_duty(), 0);
  EXPECT_GE(left.changes, 2);
  EXPECT_GE(right.changes, 2);
  EXPECT_EQ(left.changes_under_power, 0);
  EXPECT_EQ(right.changes_under_power, 0);
  expect_healthy(bench);
}

TEST(ScreedImage, CutsThePowerOfABlockedTrack) {
  Bench bench;
  set_off(bench);
  bench.tracks_blocked = true;
  bench.run_ms(1500);
  EXPECT_EQ(bench.mcu.word(kOcr1a), 0);
  EXPECT_EQ(bench.mcu.word(kOcr1b), 0);
  EXPECT_EQ(state_of(bench.last_frame(kIdHeartbeat)), RobotState::kFault);
}

TEST(ScreedImage, MeasuresTheBattery) {
  Bench bench;
  bench.board.set_battery_v(6.0);
  bench.run_ms(1500);
  EXPECT_NEAR(get_u16(bench.last_frame(kIdPower).data + 2), 6000, 30);
}

TEST(ScreedImage, KeepsItsTickWhileTheRadioIsFlooded) {
  Bench bench;
  bench.run_ms(200);
  for (int i = 0; i < 200; ++i) {
    if (bench.mcu.unreceived() < 100) bench.mcu.receive(std::vector<std::uint8_t>(100, 't'));
    bench.run_ms(10);
  }
  EXPECT_NEAR(static_cast<double>(bench.frames(kIdHeartbeat).size()), 11, 1);
  expect_healthy(bench);
}

// The receiver holds two bytes and one in its shift register. What comes meanwhile is lost, and the
// flag beside the first of the three says so.
TEST(ScreedImage, CountsWhatTheReceiverLost) {
  Bench bench;
  bench.run_ms(1000);
  const auto lost = [&bench] {
    bench.run_ms(600);
    return message::Health::unpack(bench.last_frame(kIdHealth).data).uart_errors;
  };
  ASSERT_EQ(lost(), 0);
  int taken = 0;
  for (int i = 0; i < 3; ++i) taken += bench.mcu.receive_byte('x') ? 1 : 0;
  EXPECT_EQ(taken, 3);
  EXPECT_EQ(lost(), 0);
  for (int i = 0; i < 4; ++i) taken += bench.mcu.receive_byte('x') ? 1 : 0;
  EXPECT_EQ(taken, 6);
  EXPECT_EQ(lost(), 1);
  bench.mcu.receive({'x', 'x', 'x', 'x', 'x'});
  EXPECT_EQ(lost(), 1) << "one character time apart it takes them all";
}

/// The main loop hangs for so many cycles as it begins the next tick; interrupts go on.
void hang(Bench& bench, std::uint64_t cycles) {
  std::ifstream listing(kScreedListing);
  const auto range = avr_stack::Disassembly::read(listing).range_of(
      "_ZN6screed3hal12read_sensorsERNS_12SensorSampleE");
  std::uint8_t* const code = bench.mcu.simulator()->flash + range.value().begin;
  const std::array<std::uint8_t, 2> kept = {code[0], code[1]};
  code[0] = 0xFF;  // a jump to itself
  code[1] = 0xCF;
  begin_tick(bench);
  bench.mcu.run_to(bench.mcu.cycle() + cycles);
  code[0] = kept[0];
  code[1] = kept[1];
}

// The buffer holds 128 bytes between two ticks.
TEST(ScreedImage, CountsWhatDoesNotFitIntoItsBuffer) {
  Bench bench;
  bench.run_ms(300);
  begin_tick(bench);
  bench.mcu.run_ms(5.0);
  bench.mcu.receive(std::vector<std::uint8_t>(28, 'x'));  // in 5 ms, for the tick that hangs
  bench.mcu.run_ms(4.9);
  const std::vector<std::uint8_t> flood(200, 'x');
  bench.mcu.receive(flood);
  hang(bench, 45 * kMsCycles);
  bench.run_ms(600);
  EXPECT_EQ(bench.mcu.overruns(), 0U);
  EXPECT_EQ(message::Health::unpack(bench.last_frame(kIdHealth).data).uart_errors, 28 + 200 - 128);
  EXPECT_EQ(bench.mcu.starts(), 1);
}

// Of three ticks in 35 ms one is executed, late, and two are missed: the clock goes on by all
// three.
TEST(ScreedImage, TheClockHoldsTheTicksThatItMissed) {
  Bench bench;
  bench.run_ms(2500);
  begin_tick(bench);
  bench.mcu.run_ms(5.0);
  hang(bench, 35 * kMsCycles);
  bench.run_ms(2000);
  std::vector<std::uint32_t> times_ms;
  for (const CanFrame& frame : bench.frames(kIdTime))
    times_ms.push_back(message::Time::unpack(frame.data).time);
  ASSERT_GE(times_ms.size(), 4U);
  std::uint32_t longest_ms = 0;
  for (std::size_t i = 1; i < times_ms.size(); ++i) {
    const std::uint32_t step_ms = times_ms[i] - times_ms[i - 1];
    EXPECT_GE(step_ms, message::Time::kPeriod_ms);
    longest_ms = std::max(longest_ms, step_ms);
  }
  EXPECT_EQ(longest_ms, message::Time::kPeriod_ms + 20U);
}

/// Most computing time of a tick in which it hangs, us.
int longest_tick_of_a_hang(std::uint64_t cycles) {
  Bench bench;
  bench.run_ms(300);
  begin_tick(bench);
  bench.mcu.run_ms(5.0);
  hang(bench, cycles);
  bench.run_ms(600);
  EXPECT_EQ(bench.mcu.starts(), 1);
  int longest = 0;
  for (const CanFrame& frame : bench.frames(kIdHealth))
    longest = std::max<int>(longest, message::Health::unpack(frame.data).longest_tick);
  return longest;
}

TEST(ScreedImage, TheTimeOfATickHoldsTheTicksThatItMissed) {
  const int own_us = longest_tick_of_a_hang(5 * kMsCycles) - 5000;
  EXPECT_GT(own_us, 500);
  EXPECT_LT(own_us, 5000);
  for (const int ms : {15, 25, 29}) {
    const int expected_us = 1000 * ms + own_us;
    EXPECT_NEAR(longest_tick_of_a_hang(static_cast<std::uint64_t>(ms) * kMsCycles), expected_us,
                300)
        << ms;
  }
  EXPECT_EQ(longest_tick_of_a_hang(45 * kMsCycles), 32'767)
      << "what 16 bits of half microseconds hold";
  // Whatever cycle the next tick comes in, also between reading the timer and reading what was
  // missed.
  std::uint64_t cycles = 9 * kMsCycles;
  for (int i = 0; i < 3; ++i) {
    const int to_the_end_us = 10'000 - longest_tick_of_a_hang(cycles);
    cycles += static_cast<std::uint64_t>(to_the_end_us) * (kMsCycles / 1000);
  }
  cycles -= 64;
  for (int i = 0; i < 64; ++i, cycles += 2)
    EXPECT_NEAR(longest_tick_of_a_hang(cycles), 10'000, 20) << cycles;
}

TEST(ScreedImage, WatchdogStopsAHungProgramAndResetsIt) {
  Bench bench;
  set_off(bench);
  ASSERT_GT(bench.mcu.word(kOcr1a) + bench.mcu.word(kOcr1b), 0);
  bench.mcu.break_tick();
  bench.mcu.run_ms(75);
  EXPECT_EQ(bench.mcu.word(kOcr1a), 0);
  EXPECT_EQ(bench.mcu.word(kOcr1b), 0);
  EXPECT_EQ(bench.mcu.starts(), 1);
  bench.mcu.run_ms(75);
  EXPECT_EQ(bench.mcu.starts(), 2);
}

TEST(ScreedImage, UsesMostOfTheComputedStack) {
  Bench bench;
  set_off(bench);
  // The deepest way of the main program: a parameter comes into force.
  bench.command(CommandOp::kStop);
  bench.run_ms(1000);
  bench.command(CommandOp::kDisarm);
  bench.set_parameter(Parameters::k_random_seed, 7);
  EXPECT_EQ(message::CommandAck::unpack(bench.last_frame(kIdCommandAck).data).result, 0)
      << "the robot refused it";
  EXPECT_LE(bench.mcu.stack_used(), computed_stack());
  // The deepest interrupt is that of USB, and no host is plugged in here.
  EXPECT_GE(bench.mcu.stack_used(), computed_stack() * 7 / 10)
      << "the bound is far from what is used";
}

}  // namespace
}  // namespace screed::mcu
