// `screed bringup`: leads through the first hour of a robot, wire by wire. Each step says pass, or
// what is wrong. Over the board's USB cable, which carries the radio's lines (docs/bringup.md).
//
// Steps wait for what the robot shows, not for a key: whoever turns a track by hand has no hand
// left. Exit codes: 0 none failed, 1 a step did, 2 wrong input, 130 interrupted.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "firmware/protocol/node.h"
#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/ground_station/link/serial_link.h"
#include "host_sim/ground_station/telemetry/battery_charge.h"
#include "host_sim/run/experiment/board_table.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/link/robot_link.h"

namespace screed {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPump{20};
constexpr uint64_t kSecond_us = 1'000'000;
// Until then a robot has said everything that it says.
constexpr double kHeard_s = 5.0;
// A track that was moved, by hand or by its motor.
constexpr double kMoved_mm = 20.0;
constexpr double kMinTurn_deg = 45.0;
// Of a robot at rest, within a second: noise of the chips is far below.
constexpr double kMaxRestRate_dps = 4.0;
constexpr double kMaxRestAccel_g = 0.06;
// 1 g by an accelerometer that nobody has calibrated.
constexpr double kGravity_g[] = {0.8, 1.2};
// The earth's field, 250 to 650 mG, with the magnetometer's scale error.
constexpr double kField_mg[] = {200.0, 800.0};

struct BringupArguments {
  LinkArguments link;
  std::optional<std::string> radio;
  double patience_s = 30.0;
  std::vector<std::string> only;
};

/// What a step found.
struct Outcome {
  enum class Kind : uint8_t { kPass, kNote, kNotTried, kFail } kind;
  std::string text = "";

  bool failed() const { return kind == Kind::kFail; }
};
Outcome pass() {
  return {Outcome::Kind::kPass};
}
Outcome note(std::string text) {
  return {Outcome::Kind::kNote, std::move(text)};
}
Outcome not_tried(std::string text) {
  return {Outcome::Kind::kNotTried, std::move(text)};
}
Outcome fail(std::string text) {
  return {Outcome::Kind::kFail, std::move(text)};
}

void say(const std::string& step, const Outcome& outcome) {
  constexpr const char* kWords[] = {"pass", "pass, but ", "not tried: ", "FAIL: "};
  print("{:-14s} {}{}\n", step, kWords[static_cast<size_t>(outcome.kind)], outcome.text);
  std::cout << std::flush;
}

void ask(const std::string& what) {
  std::cout << "  > " << what << std::endl;
}

constexpr const char* kSides[] = {"left", "right"};
constexpr size_t kLeftSide = 0;
constexpr size_t kRightSide = 1;

class Bringup {
 public:
  explicit Bringup(const BringupArguments& arguments)
      : arguments_(arguments),
        link_(*arguments.link.port, SerialOptions{}),
        session_(link_, {command_key(arguments.link),
                         true,
                         [this](const LinkFrame& frame) { on_frame(frame); },
                         {},
                         [] { stop_if_interrupted("the bring-up"); }}) {}

  int run() {
    struct Step {
      std::string name;
      std::vector<std::string> needs;  ///< without them it would say something wrong
      std::function<Outcome()> outcome;
    };
    const std::vector<Step> steps = {
        {"board", {}, [this] { return board(); }},
        {"chips", {}, [this] { return chips(); }},
        {"level", {"chips"}, [this] { return level(); }},
        {"left encoder", {}, [this] { return encoder(kLeftSide); }},
        {"right encoder", {}, [this] { return encoder(kRightSide); }},
        {"battery", {}, [this] { return battery(); }},
        {"left motor",
         {"left encoder", "right encoder", "battery"},
         [this] { return motor(kLeftSide); }},
        {"right motor",
         {"left encoder", "right encoder", "battery"},
         [this] { return motor(kRightSide); }},
        {"turn", {"chips", "level"}, [this] { return turn(); }},
        {"nose", {"chips", "level"}, [this] { return nose(); }},
        {"magnetometer", {"chips"}, [this] { return magnetometer(); }},
        {"radio", {}, [this] { return radio(); }},
        {"arm", {}, [this] { return arm(); }},
    };
    const std::set<std::string> only(arguments_.only.begin(), arguments_.only.end());
    for (const std::string& name : only) {
      if (std::none_of(steps.begin(), steps.end(), [&](const Step& it) { return it.name == name; }))
        throw InputError("--only " + name + ": no step of this name; see screed bringup --help");
    }
    std::set<std::string> failed;
    for (const Step& step : steps) {
      const bool first = &step == steps.data();
      if (!first && !only.empty() && only.count(step.name) == 0) continue;
      const auto broken = std::find_if(step.needs.begin(), step.needs.end(),
                                       [&](const auto& name) { return failed.count(name) != 0; });
      const Outcome outcome =
          broken != step.needs.end() ? not_tried("first the " + *broken) : step.outcome();
      say(step.name, outcome);
      if (!outcome.failed()) continue;
      failed.insert(step.name);
      if (first) break;  // nothing else can be seen
    }
    return failed.empty() ? 0 : 1;
  }

 private:
  using Vector = std::array<double, 3>;

  // ---- what the robot shows ----

  void on_frame(const LinkFrame& frame) {
    const RobotHistory* const robot = fleet_.add_frame(frame);
    if (robot == nullptr) return;
    robot_ = robot;
    node_ = node_of(frame.frame.id);
    const std::string_view name = find_message(frame.frame.id)->name;
    if (name == "ENCODERS") count();
    if (name == "GYRO_RAW") integrate(frame.time_us);
  }

  /// Counts since clear_counts(), which do not wrap.
  void count() {
    const int64_t now[] = {*robot_->raw("encoders.left"), *robot_->raw("encoders.right")};
    for (const size_t side : {kLeftSide, kRightSide}) {
      if (counted_) {
        counts_[side] += static_cast<int16_t>(static_cast<uint16_t>(now[side] - last_count_[side]));
        stirred_[side] |= now[side] != last_count_[side];
      }
      last_count_[side] = now[side];
    }
    counted_ = true;
  }
  void clear_counts() {
    counts_ = {};
    stirred_ = {};
  }
  bool moved(size_t side) const { return std::abs(counts_[side]) >= moved_counts_; }
  bool either_moved() const { return moved(kLeftSide) || moved(kRightSide); }

  /// Turned about each axis since it was cleared, deg.
  void integrate(uint64_t now_us) {
    const double passed_s = static_cast<double>(now_us - turned_us_) * 1e-6;
    turned_us_ = now_us;
    const Vector rate = vector("gyro_raw");
    for (size_t axis = 0; axis < 3; ++axis) {
      if (passed_s < 1.0) turned_deg_[axis] += (rate[axis] - rest_dps_[axis]) * passed_s;
    }
  }

  double value(const std::string& path) const {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    return robot_ == nullptr ? kNothing : robot_->value(path).value_or(kNothing);
  }
  Vector vector(const std::string& message) const {
    return {value(message + ".x"), value(message + ".y"), value(message + ".z")};
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
  /// What the robot measures; some of it comes once a second. Not a number where it does not say
  /// so.
  double heard(const std::string& path) {
    wait_until([&] { return !std::isnan(value(path)); }, kHeard_s);
    return value(path);
  }
  /// The words of the console's answer; none when there is no console.
  std::vector<std::string> console(const std::string& command) {
    constexpr double kAnswer_s = 0.5;
    std::string answer;
    link_.take_answer();
    link_.send_text(command + "\r");
    wait_until([&] { return !(answer = link_.take_answer()).empty(); }, kAnswer_s);
    std::istringstream words(answer);
    return {std::istream_iterator<std::string>(words), {}};
  }

  /// Waits until the tracks have stood for a second: what moves them belongs to the step before.
  bool wait_for_still_tracks() {
    return wait_until(
        [this] {
          clear_counts();
          listen(1.0);
          return !stirred_[kLeftSide] && !stirred_[kRightSide];
        },
        arguments_.patience_s);
  }

  /// Waits until the robot has been at rest for a second, and takes what its gyroscope and its
  /// accelerometer say then: no chip of a gyroscope says 0.
  bool wait_for_rest() {
    return wait_until([this] { return rests_for_a_second(); }, arguments_.patience_s);
  }
  bool rests_for_a_second() {
    std::vector<Vector> rates;
    std::vector<Vector> gravities;
    wait_until(
        [&] {
          rates.push_back(vector("gyro_raw"));
          gravities.push_back(vector("accel_raw"));
          return false;
        },
        1.0);
    const auto mean_where_within = [](const std::vector<Vector>& all, double limit, Vector& mean) {
      for (size_t axis = 0; axis < 3; ++axis) {
        const auto less = [axis](const Vector& a, const Vector& b) { return a[axis] < b[axis]; };
        const auto [least, most] = std::minmax_element(all.begin(), all.end(), less);
        // Also false of what is not there.
        if (!((*most)[axis] - (*least)[axis] <= limit)) return false;
        mean[axis] =
            std::accumulate(all.begin(), all.end(), 0.0, [&](double sum, const Vector& it) {
              return sum + it[axis] / static_cast<double>(all.size());
            });
      }
      return true;
    };
    return mean_where_within(rates, kMaxRestRate_dps, rest_dps_) &&
           mean_where_within(gravities, kMaxRestAccel_g * 1e3, rest_mg_);
  }

  // ---- steps ----

  Outcome board() {
    if (std::isnan(heard("health.reset_cause")))
      return fail("no telemetry in 5 s: is the board on, flashed (make flash), and this its port?");
    // screed VERSION BOARD ...
    std::vector<std::string> words;
    const auto answered = [&] {
      words = console("v");
      return words.size() > 3 && words[0] == "screed";
    };
    if (!wait_until(answered, kHeard_s))
      return fail(
          "telemetry, but no console: this is the port of a radio module; name the board's");
    board_ = words[2];
    const double count_mm = board_constants_of(board_).count_um_q4 / 16.0 * 1e-3;
    moved_counts_ = static_cast<int>(std::lround(kMoved_mm / count_mm));
    return pass();
  }

  Outcome chips() {
    const bool first = value("health.accel_mag_chip") != 0.0;
    const bool gyro = value("health.gyro_chip") != 0.0;
    const bool baro = value("health.baro_chip") != 0.0;
    if (first && gyro && baro)
      return fail("no chip of the AltIMU-10 answers: SDA and SCL swapped, or no supply or ground");
    if (first) return fail("the LSM303D (accelerometer, magnetometer) does not answer");
    if (gyro) return fail("the L3GD20H (gyroscope) does not answer");
    return baro ? note("the LPS25H (barometer) does not answer; nothing needs it") : pass();
  }

  Outcome level() {
    ask("put the robot on level ground and leave it");
    if (!wait_for_rest()) return fail("it is never at rest: it was not left, or a chip is loose");
    size_t up = 0;
    for (const size_t axis : {1U, 2U}) {
      if (std::abs(rest_mg_[axis]) > std::abs(rest_mg_[up])) up = axis;
    }
    const double g = std::abs(rest_mg_[up]) * 1e-3;
    if (!(g > kGravity_g[0] && g < kGravity_g[1]))
      return fail(
          filled("{:.2f} g along the axis that points up or down: it does not lie level, or the "
                 "accelerometer does not measure gravity",
                 g));
    if (up != 2 || rest_mg_[2] < 0.0)
      return fail(std::string("the IMU's ") + "XYZ"[up] + " axis points " +
                  (rest_mg_[up] > 0.0 ? "up" : "down") + ": Z has to (docs/wiring.md)");
    return pass();
  }

  Outcome encoder(size_t side) {
    const size_t other = 1 - side;
    const std::string name = kSides[side];
    if (!wait_for_still_tracks()) return fail("the tracks never stand still");
    ask("turn the " + name + " track forwards by hand, a hand's width");
    if (!wait_until([this] { return either_moved(); }, arguments_.patience_s)) {
      return fail(stirred_[side]
                      ? "the count goes to and fro: one channel of the encoder is missing"
                      : "no count: the encoder's supply, or both of its channels");
    }
    if (moved(other) && !stirred_[side])
      return fail(std::string("the ") + kSides[other] +
                  " encoder counts: the plugs of both are swapped");
    if (!moved(side)) return fail("both tracks count: turn this one alone");
    if (counts_[side] < 0) return fail("it counts backwards: channels A and B are swapped");
    return pass();
  }

  Outcome battery() {
    ask("switch the battery on");
    if (!wait_until([this] { return value("power.battery") >= 1e3; }, arguments_.patience_s))
      return fail(
          filled("{:.2f} V: the battery is off, or the wire to the board's divider is loose",
                 value("power.battery") * 1e-3));
    const double volts = value("power.battery") * 1e-3;
    const int cells = board_battery_cells(board_);
    if (cells == 0)
      return note(filled("{:.2f} V is not judged: the board has no battery.ini", volts));
    const std::optional<double> charge = battery_charge(volts, cells);
    if (!charge.has_value())
      return fail(filled("{:.2f} V", volts) + " is no voltage of " + std::to_string(cells) +
                  " NiMH cells");
    return *charge < kLowCharge ? note(battery_text(volts, cells) + ": charge it") : pass();
  }

  /// The board turns the motor only while button A is held, and says whether it is; nothing where
  /// no answer came.
  std::optional<bool> order_motor(size_t side) {
    constexpr unsigned long kButtonA = 1;
    link_.send_text(side == kLeftSide ? "ml\r" : "mr\r");
    const std::vector<std::string> words = console("v");
    if (words.empty()) return std::nullopt;
    return (std::strtoul(words.back().c_str(), nullptr, 16) & kButtonA) != 0;
  }

  Outcome motor(size_t side) {
    const size_t other = 1 - side;
    constexpr double kHeld_s = 4.0;
    if (!wait_for_still_tracks()) return fail("the tracks never stand still");
    ask("put the robot on a block, tracks in the air; then hold button A of the board");
    if (!wait_until([&] { return order_motor(side) == true; }, arguments_.patience_s))
      return fail("button A was not held");
    clear_counts();
    const bool turned =
        wait_until([&] { return order_motor(side) == false || either_moved(); }, kHeld_s) &&
        either_moved();
    const std::array<int, 2> counts = counts_;
    const bool own_moved = moved(side);
    ask("let go of it");
    wait_for_still_tracks();
    if (!turned) return fail("nothing moves while button A is held: the motor's wires");
    if (!own_moved)
      return fail(std::string("the ") + kSides[other] +
                  " track moves: the motors' plugs are swapped");
    if (counts[side] < 0) return fail("it runs backwards: the motor's two wires are swapped");
    return pass();
  }

  Outcome turn() {
    return turned_about(2, 1.0, "turn the whole robot to its left, a quarter turn",
                        "it says to the right: was it turned to its left?");
  }
  // Nose up is a turn to the negative side of y, which points left.
  Outcome nose() {
    return turned_about(1, -1.0, "lift its nose until it stands on its tail, and put it down again",
                        "it says nose down: the IMU is turned by 180 degrees");
  }
  Outcome turned_about(size_t axis, double sense, const char* what, const char* other_sense) {
    if (!wait_for_rest()) return fail("it is never at rest");
    turned_deg_ = {};
    ask(what);
    const auto most = [this] {
      const auto less = [](double a, double b) { return std::abs(a) < std::abs(b); };
      return static_cast<size_t>(std::max_element(turned_deg_.begin(), turned_deg_.end(), less) -
                                 turned_deg_.begin());
    };
    if (!wait_until([&] { return std::abs(turned_deg_[most()]) >= kMinTurn_deg; },
                    arguments_.patience_s))
      return fail("the gyroscope has not seen a turn");
    if (most() != axis)
      return fail(std::string("it says about ") + "XYZ"[most()] + ": the IMU is turned");
    return sense * turned_deg_[axis] < 0.0 ? fail(other_sense) : pass();
  }

  Outcome magnetometer() {
    heard("mag_raw.x");
    const Vector field = vector("mag_raw");
    const double length = std::hypot(field[0], field[1], field[2]);
    if (std::isnan(length)) return fail("no measurement");
    if (length >= kField_mg[0] && length <= kField_mg[1]) return pass();
    return note(
        filled("{:.0f} mG: iron or a motor beside it; screed calibrate takes off what does not "
               "change",
               length));
  }

  /// Meanwhile the cable is silent: the robot hears this ground station by radio or not at all.
  Outcome radio() {
    if (!arguments_.radio.has_value()) return not_tried("name its module's port, --radio DEVICE");
    constexpr uint64_t kListened_us = 4 * kSecond_us;
    SerialLink link(*arguments_.radio, SerialOptions{});
    FleetView fleet;
    CommandSession session(
        link, {test_key(), true, [&](const LinkFrame& frame) { fleet.add_frame(frame); }, {}});
    const uint64_t end_us = wall_clock_us() + kListened_us;
    while (wall_clock_us() < end_us) {
      stop_if_interrupted("the bring-up");
      session.pump(kPump);
    }
    const RobotHistory* const robot = fleet.robot(node_);
    if (robot == nullptr)
      return fail(
          "nothing of it by radio: BD 6, AP 0, the same ID and CH on both modules; the "
          "board's TX to its module's DIN");
    if (robot->raw("heartbeat.link_alive").value_or(0) == 0)
      return fail("it sends, and hears nothing: its module's DOUT to the board's RX");
    return pass();
  }

  Outcome arm() {
    if (!arguments_.link.key.has_value()) return not_tried("name the robot's key, --key FILE");
    ask("put it on the ground and leave it");
    std::optional<CommandAnswer> answer;
    // Right after its start the robot has to lie still for some seconds.
    const auto answered = [&] {
      answer = session_.run(CommandOp::kArm);
      return answer.has_value() &&
             answer->result != static_cast<uint8_t>(message::CommandAckResult::kNotReady);
    };
    wait_until(answered, arguments_.patience_s);
    if (!answer.has_value()) return fail("no answer");
    if (!answer->done()) return fail(answer_text(*answer, robot_->latest(), wall_clock_us()));
    const std::optional<CommandAnswer> disarmed = session_.run(CommandOp::kDisarm);
    if (!disarmed.has_value() || !disarmed->done())
      return fail("it is armed and was not disarmed: screed send disarm");
    return pass();
  }

  const BringupArguments& arguments_;
  SerialLink link_;
  CommandSession session_;
  FleetView fleet_;
  const RobotHistory* robot_ = nullptr;
  uint8_t node_ = 1;
  std::string board_;
  int moved_counts_ = 1;
  bool counted_ = false;
  std::array<int64_t, 2> last_count_{};
  std::array<int, 2> counts_{};
  std::array<bool, 2> stirred_{};  ///< the count changed, and may have come back
  Vector rest_dps_{};
  Vector rest_mg_{};
  Vector turned_deg_{};
  uint64_t turned_us_ = 0;
};

}  // namespace

void register_bringup_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<BringupArguments>(
      root, program, "bringup",
      "Lead through the first hour of a robot: board, sensors, encoders, motors, radio",
      [](const BringupArguments& given) {
        catch_interrupts();
        return Bringup(given).run();
      });
  command
      .add_option("--port", arguments.link.port,
                  "The board's own serial port on USB, e.g. /dev/ttyACM0")
      ->type_name("DEVICE")
      ->required();
  command
      .add_option("--key", arguments.link.key,
                  "File with the robot's command key; without it arming is not tried")
      ->type_name("FILE");
  command.add_option("--radio", arguments.radio, "Serial port of the radio module, to test it too")
      ->type_name("DEVICE");
  command
      .add_option("--only", arguments.only,
                  "Only this step: chips, level, \"left encoder\", \"right encoder\", battery, "
                  "\"left motor\", \"right motor\", turn, nose, magnetometer, radio, arm")
      ->type_name("STEP");
  add_number(command, "--patience", arguments.patience_s,
             "How long a step waits for what it asks for [s]", {1.0, 600.0})
      ->show_default();
}

}  // namespace screed
