// `screed calibrate`: walks a person through calibrating a robot's IMU over the radio and stores
// what was found in the robot.
#include "tools/screed/link/calibrate_command.h"

#include <poll.h>
#include <unistd.h>
#include <cmath>
#include <deque>
#include <iostream>
#include <memory>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/name_list.h"
#include "host_sim/core/task_progress.h"
#include "host_sim/ground_station/calibration/imu_calibration.h"
#include "host_sim/ground_station/link/calibration_page.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/terminal_screen.h"
#include "tools/screed/link/named_parameters.h"
#include "tools/screed/link/robot_link.h"

namespace screed {
namespace {

constexpr char kNothingChanged[] = "; nothing was changed";

struct NamedValue {
  std::string name;
  uint16_t index;
  int16_t value;
};

std::vector<NamedValue> checked_values(const ImuCalibration& calibration) {
  std::vector<NamedValue> values;
  try {
    for (const CalibrationParameter& parameter : calibration_parameters(calibration)) {
      const uint16_t index = parameter_index(parameter.name);
      values.push_back({parameter.name, index, checked_parameter(index, parameter.value)});
    }
  } catch (const InputError& error) {
    throw RunError(error.what() + std::string(kNothingChanged));
  }
  return values;
}

/// The end of a message about a calibration of which `count` values are stored.
std::string stored_text(const std::vector<NamedValue>& values, std::size_t count) {
  if (count == 0) return kNothingChanged;
  std::vector<std::string> names;
  names.reserve(count);
  for (std::size_t i = 0; i < count; ++i) names.push_back(values[i].name);
  return "; stored: " + name_list(names, ", ") + "; not stored: the other " +
         std::to_string(values.size() - count) + "; calibrate again";
}

void store(const NamedValue& value, const ParameterWriter& robot, std::ostream& out) {
  robot.wait_until_ready();
  const std::optional<CommandAnswer> answer = robot.write(value.index, value.value);
  const std::string words = answer.has_value() ? robot.words(*answer) : "no answer";
  out << value.name << " = " << parameter_text(value.index, value.value) << ": " << words
      << std::endl;
  if (words != "done") throw RunError(value.name + " was not stored");
}

}  // namespace

void store_calibration(const ImuCalibration& calibration, const ParameterWriter& robot,
                       std::ostream& out) {
  const std::vector<NamedValue> values = checked_values(calibration);
  for (std::size_t i = 0; i < values.size(); ++i) {
    try {
      store(values[i], robot, out);
    } catch (const RunError& error) {
      throw RunError(error.what() + stored_text(values, i));
    } catch (const TaskStopped& stopped) {
      throw TaskStopped(stopped.what() + stored_text(values, i));
    }
  }
}

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kCalibrationPump{50};
constexpr uint64_t kCalibrationTimeout_us = 5'000'000;
constexpr uint64_t kPutDown_us = 180'000'000;
constexpr double kGyro_dps = 0.070;
constexpr double kAccel_mg = 0.244;
constexpr double kMag_mg = 0.160;

struct CalibrateArguments {
  LinkArguments link;
  bool plain = false;
  bool yes = false;
};

class Calibration {
 public:
  explicit Calibration(const CalibrateArguments& arguments)
      : arguments_(arguments),
        plain_(arguments.plain || isatty(STDOUT_FILENO) == 0),
        link_(open_link(arguments.link)),
        session_(*link_, {command_key(arguments.link),
                          true,
                          [this](const LinkFrame& frame) { on_frame(frame); },
                          {},
                          [] { stop_if_interrupted("waiting for the robot's answer"); }}) {}

  int run() {
    meet();
    if (plain_) {
      collect_plain();
    } else {
      collect_on_screen();
    }
    stop_if_interrupted("calibrating; nothing was changed");
    if (given_up_) throw RunError("calibration given up; nothing was changed");
    const ImuCalibration calibration = collector_.fit();
    print_found(calibration);
    if (!arguments_.yes && !asked("store this in the robot? [y/n] ")) {
      std::cout << "nothing was changed\n";
      return 0;
    }
    store_calibration(
        calibration,
        {[this] { wait_until_disarmed(); },
         [this](uint16_t index, int32_t value) { return session_.write_parameter(index, value); },
         [this](const CommandAnswer& answer) {
           return answer_text(answer, robot_said(), wall_clock_us());
         }},
        std::cout);
    return 0;
  }

 private:
  bool over() const { return interrupted() || given_up_; }

  void on_frame(const LinkFrame& frame) {
    if (fleet_.add_frame(frame) == nullptr || node_of(frame.frame.id) != session_.node()) return;
    heard_us_ = wall_clock_us();
    collector_.add_frame(frame.frame);
    if (find_message(frame.frame.id) != find_message("MAG_RAW")) return;
    const double field = collector_.mag_samples().back().norm() * kMag_mg;
    field_.push_back({static_cast<double>(frame.time_us) * 1e-6, field});
    if (field_.size() > 240) field_.pop_front();
  }

  void meet() {
    const uint64_t end_us = wall_clock_us() + kCalibrationTimeout_us;
    while (wall_clock_us() < end_us && !session_.ready()) {
      stop_if_interrupted("waiting for the robot");
      session_.pump(kCalibrationPump);
    }
    if (!link_->status().up) throw RunError(link_->name() + ": " + link_->status().text);
    if (!session_.ready())
      throw RunError(link_->name() + ": " + not_heard_text(fleet_, session_, *link_));
  }

  void collect_plain() {
    std::string said;
    double said_coverage = 0.0;
    while (!over() && !collector_.complete()) {
      session_.pump(kCalibrationPump);
      const std::string advice = collector_.advice();
      const double covered = collector_.mag_coverage();
      if (advice == said && covered < said_coverage + 0.1) continue;
      said = advice;
      said_coverage = covered;
      std::cout << advice << " (directions seen: " << std::lround(covered * 100.0) << " %)"
                << std::endl;
    }
  }

  void collect_on_screen() {
    TerminalScreen screen;
    while (!over() && !collector_.complete()) {
      session_.pump(kCalibrationPump);
      while (const std::optional<int> key = screen.key()) {
        given_up_ = given_up_ || *key == 'q';
      }
      TextCanvas page = screen.page();
      draw(page);
      screen.show(page);
    }
  }

  void draw(TextCanvas& page) const {
    const std::vector<CurvePoint> field(field_.begin(), field_.end());
    CalibrationPageInput input;
    input.link_name = link_->name();
    input.link = link_->status();
    input.silent_s = static_cast<double>(wall_clock_us() - heard_us_) * 1e-6;
    input.collector = &collector_;
    input.field = field;
    draw_calibration(page, input);
  }

  /// Stays the robot's ground station until there is an answer.
  bool asked(const char* question) {
    std::cout << question << std::flush;
    pollfd input{STDIN_FILENO, POLLIN, 0};
    while (poll(&input, 1, 0) <= 0) {
      stop_if_interrupted("calibrating; nothing was changed");
      session_.pump(kCalibrationPump);
    }
    std::string answer;
    return std::getline(std::cin, answer) && !answer.empty() &&
           (answer[0] == 'y' || answer[0] == 'Y');
  }

  static void row(const char* name, const Eigen::Vector3d& v, const char* unit) {
    print("  {:-26s} {:9.3f} {:9.3f} {:9.3f}  {}\n", name, v.x(), v.y(), v.z(), unit);
  }

  static void residual(const VectorFit& fit) {
    print(
        "  {:-26s} {*100:8.3f} % before, {*100:.3f} % with what is stored, {*100:.3f} % with scale "
        "as "
        "well\n",
        "lengths differ by (RMS)", fit.residual_before, fit.residual_offset, fit.residual_after);
  }

  static void print_found(const ImuCalibration& calibration) {
    print("{:-28s} {:9s} {:9s} {:9s}\n", "", "x", "y", "z");
    print("gyro\n");
    row("bias", calibration.gyro.bias * kGyro_dps, "deg/s");
    print("accelerometer\n");
    row("offset", calibration.accelerometer.correction.offset * kAccel_mg, "mg");
    row("scale", calibration.accelerometer.correction.matrix.diagonal(), "");
    residual(calibration.accelerometer);
    print("magnetometer\n");
    row("offset (hard iron)", calibration.magnetometer.correction.offset * kMag_mg, "mG");
    row("scale (soft iron)", calibration.magnetometer.correction.matrix.diagonal(), "");
    print("  {:-26s} {:9.1f} mG\n", "field", calibration.magnetometer.radius * kMag_mg);
    residual(calibration.magnetometer);
    std::cout << std::flush;
  }

  const LatestTelemetry& robot_said() const {
    static const LatestTelemetry kNothing;
    const RobotHistory* const robot = fleet_.robot(session_.node());
    return robot == nullptr ? kNothing : robot->latest();
  }

  std::string state() const { return robot_said().text("heartbeat.state"); }

  /// A robot takes parameters when it is disarmed; one that was turned over has a fault, which can
  /// be cleared when it stands level again.
  void wait_until_disarmed() {
    const uint64_t end_us = wall_clock_us() + kPutDown_us;
    bool said = false;
    while (wall_clock_us() < end_us) {
      pump_interruptible();
      if (state() == "disarmed") return;
      if (state() == "fault") {
        if (!said) std::cout << "put the robot down, level" << std::endl;
        said = true;
        session_.run(CommandOp::kClear);
      } else {
        session_.run(CommandOp::kDisarm);
      }
      const uint64_t pause_us = wall_clock_us() + 500'000;
      while (wall_clock_us() < pause_us) pump_interruptible();
    }
    throw RunError("the robot is not disarmed but '" + state() + "'");
  }

  void pump_interruptible() {
    stop_if_interrupted("waiting until the robot is disarmed");
    session_.pump(kCalibrationPump);
  }

  const CalibrateArguments& arguments_;
  bool plain_;
  std::unique_ptr<Link> link_;
  FleetView fleet_;
  ImuCollector collector_;
  std::deque<CurvePoint> field_;
  uint64_t heard_us_ = wall_clock_us();  ///< the robot, last
  bool given_up_ = false;
  CommandSession session_;
};

}  // namespace

void register_calibrate_command(Command& root, Program& program) {
  auto [command, arguments] =
      add_subcommand<CalibrateArguments>(root, program, "calibrate",
                                         "Calibrate a robot's IMU from six positions and a turn "
                                         "in all directions, and store the result",
                                         [](const CalibrateArguments& given) {
                                           catch_interrupts();
                                           return Calibration(given).run();
                                         });
  add_link_options(command, arguments.link);
  add_key_option(command, arguments.link);
  command.add_flag("--plain", arguments.plain, "Print lines of text instead of a full-screen page");
  command.add_flag("--yes", arguments.yes, "Store the result without asking");
}

}  // namespace screed
