// `screed bringup` at the simulated board: the flashed image in simavr, its USB at a serial port,
// somebody who does what the program asks for, and a wrong wire.
// Long: a person's hands and the program's waits go by the clock on the wall.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include "host_sim/devices/mcu/board.h"
#include "host_sim/ground_station/link/pseudo_terminal.h"
#include "host_sim/run/simulation/run_loop.h"
#include "tests/mcu/images.h"
#include "tests/mcu/usb_host.h"
#include "tests/sitl/background.h"
#include "tests/temp_folder.h"

namespace screed::mcu {
namespace {

using screed::testing::Background;

enum class Wire {
  kAllRight,
  kLeftEncoderSwapped,   // channels A and B
  kRightChannelMissing,  // B
  kEncodersSwapped,      // the plugs of both
  kLeftMotorReversed,    // its two wires
  kMotorsSwapped,        // the plugs of both
  kBatteryOff,
  kGyroMissing,
  kImuUpsideDown,
};

/// Somebody at a board on a bench.
class Person {
 public:
  explicit Person(Wire wire)
      : wire_(wire), board_(kScreedImage, read_wiring(kWiring)), usb_(board_.mcu) {
    for (const PinName pin : kButtons) board_.mcu.set_pin(pin, true);
    if (wire == Wire::kRightChannelMissing) board_.break_encoder_wire(kRight, 1);
    if (wire == Wire::kGyroMissing) board_.gyro.present = false;
    measure();
    board_.mcu.run_ms(50);
    EXPECT_TRUE(usb_.plug_in());
    EXPECT_TRUE(usb_.set_line(115200, true));
  }

  std::string port() const { return port_.device().string(); }

  /// Ten milliseconds. `asked`: what the program asked for last; a movement of the hands that it
  /// began goes on to its end, whatever is asked for meanwhile.
  void step(const std::string& asked) {
    const bool anew = asked != asked_;
    asked_ = asked;
    const auto wants = [&](const char* words) { return asked.find(words) != std::string::npos; };
    if (anew) {
      if (wants("left track forwards")) by_hand_ms_[kLeft] = 1800.0;
      if (wants("right track forwards")) by_hand_ms_[kRight] = 1800.0;
      if (wants("to its left")) turn_ms_ = 1500.0;
      if (wants("lift its nose")) nose_ms_ = 1500.0;
    }
    const auto goes_on = [](double& left_ms) {
      left_ms -= 10.0;
      return left_ms >= 0.0;
    };
    for (const Side side : {kLeft, kRight}) {
      if (goes_on(by_hand_ms_[side])) turned_[side] += kByHand;
    }
    board_.mcu.set_pin(kButtons[0], !wants("hold button A"));
    rate_dps_ = kBias_dps;
    if (goes_on(turn_ms_)) rate_dps_.z() += 60.0;
    if (goes_on(nose_ms_)) rate_dps_.y() -= 60.0;
    run_motors();
    measure();
    const std::vector<uint8_t> typed = port_.read();
    if (!typed.empty()) usb_.send(std::string(typed.begin(), typed.end()));
    const std::string said = usb_.listen_ms(10);
    port_.write({reinterpret_cast<const uint8_t*>(said.data()), said.size()});
  }

 private:
  /// Counts in 10 ms; no whole number: telemetry samples them.
  static constexpr double kByHand = 0.93;
  /// No gyroscope says 0 at rest.
  inline static const Eigen::Vector3d kBias_dps{6.0, -4.0, 3.0};
  static constexpr PinName kButtons[] = {{'B', 3}, {'D', 5}, {'B', 0}};

  void run_motors() {
    constexpr double kCountsAt1 = 440.0;  // a second
    if (wire_ == Wire::kBatteryOff) return;
    for (const Side side : {kLeft, kRight}) {
      Side plug = side;
      if (wire_ == Wire::kMotorsSwapped) plug = side == kLeft ? kRight : kLeft;
      double ratio = board_.motor_duty_ratio(plug);
      if (wire_ == Wire::kLeftMotorReversed && side == kLeft) ratio = -ratio;
      turned_[static_cast<size_t>(side)] += ratio * kCountsAt1 * 0.01;
    }
  }

  void measure() {
    for (const Side side : {kLeft, kRight}) {
      Side plug = side;
      if (wire_ == Wire::kEncodersSwapped) plug = side == kLeft ? kRight : kLeft;
      auto count = static_cast<std::int64_t>(std::floor(turned_[static_cast<size_t>(side)]));
      if (wire_ == Wire::kLeftEncoderSwapped && side == kLeft) count = -count;
      board_.set_encoder(plug, count);
    }
    // A chip repeats itself to the bit only where it is dead.
    noise_ = (noise_ + 1) % 3;
    Eigen::Vector3d up(noise_ * 0.244, 0.0, 1000.0);
    Eigen::Vector3d rate = rate_dps_ + 0.07 * Eigen::Vector3d(noise_ - 1, 0.0, noise_ % 2);
    Eigen::Vector3d field(200.0, 0.0, -440.0);
    if (wire_ == Wire::kImuUpsideDown) {
      for (Eigen::Vector3d* it : {&up, &rate, &field})
        *it = Eigen::Vector3d(it->x(), -it->y(), -it->z());
    }
    board_.set_acceleration(up);
    board_.set_angular_rate(rate);
    board_.set_magnetic_field(field);
    board_.set_battery_v(wire_ == Wire::kBatteryOff ? 0.2 : 7.6);
  }

  Wire wire_;
  Board board_;
  UsbHost usb_;
  PseudoTerminal port_;
  std::array<double, 2> turned_{};  ///< tracks, forwards, counts
  Eigen::Vector3d rate_dps_ = Eigen::Vector3d::Zero();
  int noise_ = 0;
  std::string asked_;
  std::array<double, 2> by_hand_ms_{};
  double turn_ms_ = 0.0;
  double nose_ms_ = 0.0;
};

class BringUp : public ::testing::Test {
 protected:
  /// What the program says at this board, and its exit code.
  std::pair<std::string, int> run(Wire wire, const std::vector<std::string>& only) {
    Person person(wire);
    std::vector<std::string> arguments = {"bringup", "--port", person.port(), "--patience", "4"};
    for (const std::string& step : only) arguments.insert(arguments.end(), {"--only", step});
    const std::string log = (folder_.path() / "said").string();
    Background program(std::getenv("SCREED_PROGRAM"), arguments, folder_.path(), log);
    WallClock clock;
    Pacer pacer(clock, true);
    for (double now_s = 0.0; program.runs(); now_s += 0.01) {
      const std::string said = read_text(log);
      const size_t last = said.rfind("  > ");
      person.step(last == std::string::npos ? "" : said.substr(last, said.find('\n', last) - last));
      pacer.wait_until(now_s);
    }
    return {read_text(log), program.wait()};
  }

  TempFolder folder_;
};

TEST_F(BringUp, PassesARobotThatIsWiredRight) {
  const auto [said, exit_code] = run(Wire::kAllRight, {});
  EXPECT_EQ(said.find("FAIL"), std::string::npos) << said;
  EXPECT_NE(said.find("not tried: name its module's port"), std::string::npos) << said;
  EXPECT_NE(said.find("not tried: name the robot's key"), std::string::npos) << said;
  for (const char* step : {"board", "chips", "battery", "level", "left encoder", "right encoder",
                           "left motor", "right motor", "turn", "nose", "magnetometer"}) {
    const size_t at = said.find(std::string("\n") + step);
    const size_t first = said.rfind(step, 0) == 0 ? 0 : at;
    ASSERT_NE(first, std::string::npos) << step << ": " << said;
    EXPECT_NE(said.find("pass\n", first), std::string::npos) << said;
  }
  EXPECT_EQ(exit_code, 0) << said;
}

// A motor judged by an encoder that is wrong would be called wrong as well.
TEST_F(BringUp, DoesNotJudgeWhatAWrongWireHides) {
  const auto [said, exit_code] = run(Wire::kLeftEncoderSwapped, {"left encoder", "left motor"});
  EXPECT_EQ(exit_code, 1);
  EXPECT_NE(said.find("left motor     not tried: first the left encoder\n"), std::string::npos)
      << said;
  const auto [dead, dead_code] = run(Wire::kGyroMissing, {"chips", "turn"});
  EXPECT_EQ(dead_code, 1);
  EXPECT_NE(dead.find("turn           not tried: first the chips\n"), std::string::npos) << dead;
}

struct Fault {
  Wire wire;
  std::string step;
  std::string words;
};

TEST_F(BringUp, FindsEachOfEightWrongWires) {
  const std::vector<Fault> faults = {
      {Wire::kLeftEncoderSwapped, "left encoder", "channels A and B are swapped"},
      {Wire::kRightChannelMissing, "right encoder", "one channel of the encoder is missing"},
      {Wire::kEncodersSwapped, "left encoder", "the plugs of both are swapped"},
      {Wire::kLeftMotorReversed, "left motor", "the motor's two wires are swapped"},
      {Wire::kMotorsSwapped, "right motor", "the motors' plugs are swapped"},
      {Wire::kBatteryOff, "battery", "the battery is off"},
      {Wire::kGyroMissing, "chips", "the L3GD20H (gyroscope) does not answer"},
      {Wire::kImuUpsideDown, "level", "the IMU's Z axis points down"},
  };
  for (const Fault& fault : faults) {
    const auto [said, exit_code] = run(fault.wire, {fault.step});
    EXPECT_EQ(exit_code, 1) << fault.step << ": " << said;
    EXPECT_NE(said.find(fault.step), std::string::npos) << said;
    EXPECT_NE(said.find(fault.words), std::string::npos) << fault.step << ": " << said;
  }
}

}  // namespace
}  // namespace screed::mcu
