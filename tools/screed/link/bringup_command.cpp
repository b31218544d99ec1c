// `screed bringup`: leads through the first hour of a robot, wire by wire. Each step says pass, or
// what is wrong. Over the board's USB cable, which carries the radio's lines (docs/bringup.md).
//
// Steps wait for what the robot shows, not for a key: whoever turns a track by hand has no hand
// left. Exit codes: 0 all passed, 1 a step did not, 2 wrong input, 130 interrupted.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/ground_station/link/serial_link.h"
#include "host_sim/ground_station/telemetry/battery_charge.h"
#include "host_sim/run/experiment/board_table.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/link/link_options.h"

namespace screed {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPump{20};
constexpr uint64_t kSecond_us = 1'000'000;
// To be moved by hand: some 20 mm of track.
constexpr int kByHand_counts = 40;
// What a track that stands still may tremble by.
constexpr int kStill_counts = 8;
constexpr double kMinTurn_deg = 45.0;
constexpr double kField_mg[] = {200.0, 800.0};  ///< of the earth, with the scale's error

struct BringupArguments {
  LinkArguments link;
  std::optional<std::string> radio;
  std::string board = kDefaultBoard;
  double patience_s = 30.0;
  std::vector<std::string> only;
};

enum class Side : uint8_t { kLeft, kRight };

const char* name_of(Side side) {
  return side == Side::kLeft ? "left" : "right";
}

struct Counts {
  int left = 0;
  int right = 0;
  bool stirred = false;  ///< one of them changed, and may have come back
};

class Bringup {
 public:
  explicit Bringup(const BringupArguments& arguments)
      : arguments_(arguments),
        link_(open_serial_link(arguments.link)),
        session_(*link_, {command_key(arguments.link),
                          true,
                          [this](const LinkFrame& frame) { on_frame(frame); },
                          {},
                          [] { stop_if_interrupted("the bring-up"); }}) {}

  int run() {
    struct Step {
      const char* name;
      std::function<std::string()> problem;
    };
    const std::vector<Step> steps = {
        {"board", [this] { return board(); }},
        {"chips", [this] { return chips(); }},
        {"battery", [this] { return battery(); }},
        {"level", [this] { return level(); }},
        {"left encoder", [this] { return encoder(Side::kLeft); }},
        {"right encoder", [this] { return encoder(Side::kRight); }},
        {"left motor", [this] { return motor(Side::kLeft); }},
        {"right motor", [this] { return motor(Side::kRight); }},
        {"turn", [this] { return turn(); }},
        {"nose", [this] { return nose(); }},
        {"magnetometer", [this] { return magnetometer(); }},
        {"radio", [this] { return radio(); }},
        {"arm", [this] { return arm(); }},
    };
    for (const std::string& name : arguments_.only) {
      if (std::none_of(steps.begin(), steps.end(),
                       [&](const Step& step) { return name == step.name; }))
        throw InputError("--only " + name + ": no step of this name; see screed bringup --help");
    }
    int failed = 0;
    for (const Step& step : steps) {
      const auto& only = arguments_.only;
      const bool first = step.name == std::string("board");
      if (!first && !only.empty() && std::find(only.begin(), only.end(), step.name) == only.end())
        continue;
      if (step.name == std::string("radio") && !arguments_.radio.has_value()) {
        std::printf("%-14s not tried: name its module's port, --radio DEVICE\n", step.name);
        continue;
      }
      const std::string problem = step.problem();
      std::printf("%-14s %s\n", step.name, problem.empty() ? "pass" : ("FAIL: " + problem).c_str());
      std::fflush(stdout);
      if (problem.empty()) continue;
      ++failed;
      if (first) break;  // nothing else can be seen
    }
    return failed == 0 ? 0 : 1;
  }

 private:
  void on_frame(const LinkFrame& frame) {
    const RobotHistory* const robot = fleet_.add_frame(frame);
    if (robot == nullptr) return;
    robot_ = robot;
    const std::string_view name = find_message(frame.frame.id)->name;
    if (name == "ENCODERS") count();
    if (name == "GYRO_RAW") integrate(frame.time_us);
  }

  /// Counts since count_from_here(), which do not wrap.
  void count() {
    const auto step = [](int64_t now, int64_t before) {
      return static_cast<int16_t>(static_cast<uint16_t>(now - before));
    };
    const int64_t left = *robot_->raw("encoders.left");
    const int64_t right = *robot_->raw("encoders.right");
    if (counted_) {
      counts_.left += step(left, left_);
      counts_.right += step(right, right_);
      counts_.stirred |= left != left_ || right != right_;
    }
    left_ = left;
    right_ = right;
    counted_ = true;
  }

  /// Turned about each axis since turn_from_here(), deg; the robot stood still before.
  void integrate(uint64_t now_us) {
    const double rate[3] = {*robot_->value("gyro_raw.x"), *robot_->value("gyro_raw.y"),
                            *robot_->value("gyro_raw.z")};
    const double passed_s = static_cast<double>(now_us - turned_us_) * 1e-6;
    turned_us_ = now_us;
    for (int axis = 0; axis < 3; ++axis) {
      if (passed_s < 1.0) turned_deg_[axis] += (rate[axis] - rest_dps_[axis]) * passed_s;
    }
  }

  /// False when the time is over before.
  bool wait_until(const std::function<bool()>& holds, double seconds) {
    const uint64_t end_us = wall_clock_us() + static_cast<uint64_t>(seconds * 1e6);
    while (!holds()) {
      stop_if_interrupted("the bring-up");
      if (wall_clock_us() >= end_us) return false;
      session_.pump(kPump);
    }
    return true;
  }
  void listen(double seconds) {
    wait_until([] { return false; }, seconds);
  }
  double value(const char* path) const {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    return robot_ == nullptr ? kNothing : robot_->value(path).value_or(kNothing);
  }
  /// What the robot measures; some of it comes once a second. Not a number where it does not say
  /// so.
  double heard(const char* path) {
    constexpr double kHeard_s = 5.0;
    wait_until([&] { return !std::isnan(value(path)); }, kHeard_s);
    return value(path);
  }
  static void ask(const std::string& what) { std::cout << "  > " << what << std::endl; }
  static std::string text(const char* pattern, double number) {
    char line[96];
    std::snprintf(line, sizeof line, pattern, number);
    return line;
  }

  std::string board() {
    if (!std::isnan(heard("health.reset_cause"))) return "";
    return "no telemetry in 5 s: is the board on, flashed (make flash), and this its port? By "
           "radio: BD, ID and CH of both modules (docs/link.md)";
  }

  std::string chips() {
    const bool first = value("health.accel_mag_chip") != 0.0;
    const bool gyro = value("health.gyro_chip") != 0.0;
    const bool baro = value("health.baro_chip") != 0.0;
    if (first && gyro && baro)
      return "no chip of the AltIMU-10 answers: SDA and SCL swapped, or no supply or ground";
    if (first) return "the LSM303D (accelerometer, magnetometer) does not answer";
    if (gyro) return "the L3GD20H (gyroscope) does not answer";
    return baro ? "the LPS25H (barometer) does not answer; nothing needs it" : "";
  }

  std::string battery() {
    const double volts = heard("power.battery") * 1e-3;
    const int cells = board_battery_cells(arguments_.board);
    if (volts < 1.0)
      return text("%.2f V: the battery is off, or the wire to the board's divider is loose", volts);
    const std::optional<double> charge = battery_charge(volts, cells);
    if (!charge.has_value())
      return text("%.2f V", volts) + " is no voltage of " + std::to_string(cells) + " NiMH cells";
    return *charge < kLowCharge ? battery_text(volts, cells) + ": charge it" : "";
  }

  std::string level() {
    ask("put the robot on level ground and leave it");
    listen(1.0);
    for (int axis = 0; axis < 3; ++axis) rest_dps_[axis] = value(kGyro[axis]);
    const double g[3] = {value("accel_raw.x") * 1e-3, value("accel_raw.y") * 1e-3,
                         value("accel_raw.z") * 1e-3};
    const char* const axes = "XYZ";
    int up = 0;
    for (int axis = 1; axis < 3; ++axis) {
      if (std::abs(g[axis]) > std::abs(g[up])) up = axis;
    }
    if (!(std::abs(g[up]) > 0.8 && std::abs(g[up]) < 1.2))
      return text("%.2f g in all: the accelerometer does not measure gravity, or the robot moves",
                  std::sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]));
    if (up != 2 || g[2] < 0.0)
      return std::string("the IMU's ") + axes[up] + " axis points " +
             (g[up] > 0.0 ? "up" : "down") + ": Z has to (docs/wiring.md)";
    return "";
  }

  std::string encoder(Side side) {
    const std::string name = name_of(side);
    counts_ = {};
    ask("turn the " + name + " track forwards by hand, a hand's width");
    const bool moved = wait_until(
        [this] {
          return std::abs(counts_.left) >= kByHand_counts ||
                 std::abs(counts_.right) >= kByHand_counts;
        },
        arguments_.patience_s);
    const auto [own, other] = of(side);
    if (!moved) {
      return counts_.stirred ? "the count goes to and fro: one channel of the encoder is missing"
                             : "no count: the encoder's supply, or both of its channels";
    }
    if (std::abs(other) >= kByHand_counts)
      return std::string("the ") + name_of(side == Side::kLeft ? Side::kRight : Side::kLeft) +
             " encoder counts: the plugs of both are swapped";
    if (own < 0) return "it counts backwards: channels A and B are swapped";
    return "";
  }

  std::string motor(Side side) {
    const std::string name = name_of(side);
    ask("put the robot on a block, tracks in the air; hold button A of the board");
    const double end_s = arguments_.patience_s;
    counts_ = {};
    const char* const order = side == Side::kLeft ? "ml\r" : "mr\r";
    uint64_t next_us = 0;
    const bool moved = wait_until(
        [&] {
          if (wall_clock_us() >= next_us) {
            link_->send_text(order);
            next_us = wall_clock_us() + kSecond_us / 2;
          }
          return std::abs(counts_.left) >= kByHand_counts ||
                 std::abs(counts_.right) >= kByHand_counts;
        },
        end_s);
    const auto [own, other] = of(side);
    ask("let go of it");
    listen(1.5);
    if (!moved) return "nothing moves: button A not held, battery off, or the motor's wires";
    if (std::abs(own) <= kStill_counts && std::abs(other) >= kByHand_counts)
      return "the other track moves: the motors' plugs are swapped";
    if (own < 0) return "it runs backwards: the motor's two wires are swapped";
    return "";
  }

  std::string turn() {
    std::fill(std::begin(turned_deg_), std::end(turned_deg_), 0.0);
    ask("turn the whole robot to its left, a quarter turn");
    return turned_about(2, 1.0, "to the left");
  }

  std::string nose() {
    std::fill(std::begin(turned_deg_), std::end(turned_deg_), 0.0);
    ask("lift its nose until it stands on its tail, and put it down again");
    // Nose up is a turn to the negative side of y, which points left.
    return turned_about(1, -1.0, "nose up");
  }

  std::string turned_about(int axis, double sense, const char* how) {
    const auto most = [this] {
      int found = 0;
      for (int i = 1; i < 3; ++i) {
        if (std::abs(turned_deg_[i]) > std::abs(turned_deg_[found])) found = i;
      }
      return found;
    };
    if (!wait_until([&] { return std::abs(turned_deg_[most()]) >= kMinTurn_deg; },
                    arguments_.patience_s))
      return "the gyroscope has not seen a turn";
    const char* const axes = "XYZ";
    if (most() != axis)
      return std::string("turned ") + how + ", it says about " + axes[most()] +
             ": the IMU is turned";
    if (sense * turned_deg_[axis] < 0.0)
      return std::string("turned ") + how +
             ", it says the other way: the IMU is turned by 180 degrees";
    return "";
  }

  std::string magnetometer() {
    const double field =
        std::sqrt(std::pow(heard("mag_raw.x"), 2) + std::pow(value("mag_raw.y"), 2) +
                  std::pow(value("mag_raw.z"), 2));
    if (field >= kField_mg[0] && field <= kField_mg[1]) return "";
    return text(
        "%.0f mG: iron or a motor beside it; screed calibrate takes what does not change off",
        field);
  }

  std::string radio() {
    LinkArguments by_radio = arguments_.link;
    by_radio.port = arguments_.radio;
    by_radio.pty.reset();
    const std::unique_ptr<Link> link = open_link(by_radio);
    FleetView heard;
    std::vector<LinkFrame> frames;
    const uint64_t end_us = wall_clock_us() + 5 * kSecond_us;
    while (heard.robots().empty() && wall_clock_us() < end_us) {
      stop_if_interrupted("the bring-up");
      frames.clear();
      link->receive(kPump, frames);
      for (const LinkFrame& frame : frames) heard.add_frame(frame);
    }
    if (!heard.robots().empty()) return "";
    return "nothing by radio: BD 6, AP 0, the same ID and CH on both modules; DOUT to the board's "
           "RX";
  }

  std::string arm() {
    ask("put it on the ground and leave it");
    std::string reason = "no answer";
    const auto armed = [&] {
      const std::optional<CommandAnswer> answer = session_.run(CommandOp::kArm);
      if (answer.has_value() && answer->done()) return true;
      if (answer.has_value()) reason = answer_text(*answer, robot_->latest(), wall_clock_us());
      return false;
    };
    if (!wait_until(armed, arguments_.patience_s)) return reason;
    session_.run(CommandOp::kDisarm);
    return "";
  }

  std::pair<int, int> of(Side side) const {
    return side == Side::kLeft ? std::pair(counts_.left, counts_.right)
                               : std::pair(counts_.right, counts_.left);
  }

  static constexpr const char* kGyro[] = {"gyro_raw.x", "gyro_raw.y", "gyro_raw.z"};

  const BringupArguments& arguments_;
  std::unique_ptr<SerialLink> link_;
  CommandSession session_;
  FleetView fleet_;
  const RobotHistory* robot_ = nullptr;
  bool counted_ = false;
  int64_t left_ = 0;
  int64_t right_ = 0;
  Counts counts_;
  double rest_dps_[3] = {};
  double turned_deg_[3] = {};
  uint64_t turned_us_ = 0;
};

}  // namespace

void register_bringup_command(Command& root, Program& program) {
  auto arguments = std::make_shared<BringupArguments>();
  Command* command = root.add_subcommand(
      "bringup", "Lead through the first hour of a robot: board, sensors, encoders, motors, radio");
  add_link_options(*command, arguments->link);
  add_key_option(*command, arguments->link);
  command
      ->add_option("--radio", arguments->radio, "Serial port of the radio module, to test it too")
      ->type_name("DEVICE");
  command->add_option("--board", arguments->board, "Board of the robot, for its battery")
      ->type_name("NAME")
      ->show_default();
  command
      ->add_option("--only", arguments->only,
                   "Only this step: chips, battery, level, \"left encoder\", \"right encoder\", "
                   "\"left motor\", \"right motor\", turn, nose, magnetometer, radio, arm")
      ->type_name("STEP");
  add_number(*command, "--patience", arguments->patience_s,
             "How long a step waits for what it asks for [s]", {1.0, 600.0})
      ->show_default();
  command->callback([arguments, &program] {
    program.action = [arguments] {
      catch_interrupts();
      return Bringup(*arguments).run();
    };
  });
}

}  // namespace screed
