// `screed drive`: a person drives a robot by keys or gamepad, with its telemetry beside.
//
// Every direction is a dead man's key: the robot moves while the key is held down and stands as
// soon as it is let go, the terminal goes away or this program ends.
#include <unistd.h>

#include <algorithm>
#include <array>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/ground_station/link/dashboard.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/ground_station/link/robot_pilot.h"
#include "host_sim/ground_station/telemetry/candump_log.h"
#include "host_sim/run/experiment/board_table.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/terminal_screen.h"
#include "tools/screed/link/robot_link.h"
#include "tools/screed/viewer/window.h"

namespace screed {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kPilotPump{20};
// A terminal repeats a key that is held down, for the first time after up to 0.5 s, then many times
// a second.
constexpr uint64_t kFirstRepeat_us = 600'000;
constexpr uint64_t kRepeat_us = 250'000;
// To stand, disarmed, when the user leaves: three commands and their answers.
constexpr uint64_t kRelease_us = 5'000'000;

struct DriveArguments {
  LinkArguments link;
  double speed_m_per_s = 0.15;
  double turn_deg_per_s = 45.0;
  std::optional<std::string> log;
  std::string board = kDefaultBoard;
};

/// Directions that keys ask for, each as long as it is held down.
class HeldDirections {
 public:
  /// False: the key is none of a direction.
  bool press(int key, uint64_t now_us) {
    for (const Direction& it : kDirections) {
      if (std::find(it.keys.begin(), it.keys.end(), key) == it.keys.end()) continue;
      const bool again = it.forward == forward_ && it.left == left_ && now_us < until_us_;
      until_us_ = now_us + (again ? kRepeat_us : kFirstRepeat_us);
      forward_ = it.forward;
      left_ = it.left;
      return true;
    }
    return false;
  }
  bool held(uint64_t now_us) const { return now_us < until_us_; }
  void let_go() { until_us_ = 0; }
  double forward() const { return forward_; }
  double left() const { return left_; }

 private:
  struct Direction {
    std::array<int, 2> keys;
    double forward;
    double left;
  };
  /// Arrows, and the letters of ROS's teleop_twist_keyboard, which have arcs as well.
  static constexpr Direction kDirections[] = {
      {{kTerminalUp, 'i'}, 1.0, 0.0},   {{kTerminalDown, ','}, -1.0, 0.0},
      {{kTerminalLeft, 'j'}, 0.0, 1.0}, {{kTerminalRight, 'l'}, 0.0, -1.0},
      {{'u', 'u'}, 1.0, 1.0},           {{'o', 'o'}, 1.0, -1.0},
      {{'m', 'm'}, -1.0, -1.0},         {{'.', '.'}, -1.0, 1.0},
  };

  uint64_t until_us_ = 0;
  double forward_ = 0.0;
  double left_ = 0.0;
};

class PersonDrives {
 public:
  explicit PersonDrives(const DriveArguments& arguments)
      : arguments_(arguments),
        link_(open_link(arguments.link)),
        pilot_(*link_, {command_key(arguments.link), std::nullopt, [] { return wall_clock_us(); },
                        [this](const LinkFrame& frame) { on_frame(frame); }}),
        board_(board_constants_of(arguments.board)),
        cells_(board_battery_cells(arguments.board)),
        speed_(arguments.speed_m_per_s) {
    if (arguments.log.has_value()) log_.emplace(*arguments.log, link_->name());
  }

  int run() {
    {
      TerminalScreen screen;
      pilot_.begin();
      while (!quit_ && !interrupted()) step(screen);
      pilot_.release();
      const uint64_t end_us = wall_clock_us() + kRelease_us;
      while (!pilot_.released() && wall_clock_us() < end_us) show(screen);
    }
    if (log_.has_value()) log_->check();
    if (!pilot_.released())
      throw RunError(
          link_->name() +
          ": the robot did not say that it is disarmed again; it stops without heartbeats");
    return 0;
  }

 private:
  void on_frame(const LinkFrame& frame) {
    if (log_.has_value()) log_->add(frame.time_us, frame.frame);
    const bool first = fleet_.add_frame(frame) != nullptr && !fleet_.robots().contains(robot_);
    if (first) robot_ = fleet_.robots().begin()->first;
  }

  void step(TerminalScreen& screen) {
    while (const std::optional<int> key = screen.key()) press(*key);
    for (const viewer::InputEvent& event : gamepad_.poll()) {
      if (event.kind == viewer::InputEvent::Kind::kKeyPressed) {
        press(event.key);
      } else if (event.kind != viewer::InputEvent::Kind::kKeyReleased) {
        sticks_.gamepad_event(event);
      }
    }
    const bool by_key = keys_.held(wall_clock_us());
    const double forward = by_key ? keys_.forward() : sticks_.forward();
    const double left = by_key ? keys_.left() : sticks_.left();
    order_ = {forward * speed_, left * arguments_.turn_deg_per_s};
    if (by_key || sticks_.drives() || pilot_.drives()) pilot_.drive(order_);
    show(screen);
  }

  void press(int key) {
    if (keys_.press(key, wall_clock_us())) return;
    keys_.let_go();
    switch (key) {
      case kEmergencyStopKey:
        pilot_.emergency_stop();
        break;
      case 'c':
        pilot_.clear_fault();
        break;
      case kTerminalBackspace:
      case viewer::kKeyBackspace:
        pilot_.hand_back();
        break;
      case '+':
        speed_ = std::min(1.25 * speed_, arguments_.speed_m_per_s);
        break;
      case '-':
        speed_ = std::max(0.8 * speed_, 0.02);
        break;
      case 'q':
        quit_ = true;
        break;
      default:
        break;
    }
  }

  void show(TerminalScreen& screen) {
    pilot_.pump(kPilotPump);
    DashboardInput input;
    input.now_us = wall_clock_us();
    input.link_name = link_->name();
    input.link = link_->status();
    input.fleet = &fleet_;
    input.robot = robot_;
    input.board = &board_;
    input.battery_cells = cells_;
    input.curves = {"leveling.speed", "leveling.turn_rate", "attitude.pitch"};
    const std::string more = pilot_.description();
    input.footer = {more.empty() ? std::string(kEmergencyStopKeyName) + " emergency stop" : more,
                    order_text(),
                    "u i o j l m , . as well",
                    "+/- speed",
                    "c clear",
                    "Backspace: the algorithm",
                    "q quit"};
    TextCanvas page = screen.page();
    draw_dashboard(page, input);
    screen.show(page);
  }

  std::string order_text() const {
    if (!pilot_.drives()) return "hold an arrow key to drive";
    if (order_.speed_m_per_s == 0.0 && order_.yaw_rate_deg_per_s == 0.0) return "you stand";
    return filled("you drive {:.2f} m/s, {:.0f} deg/s", order_.speed_m_per_s,
                  order_.yaw_rate_deg_per_s);
  }

  const DriveArguments& arguments_;
  std::unique_ptr<Link> link_;
  std::optional<CandumpWriter> log_;
  FleetView fleet_;
  RobotKey robot_;
  RobotPilot pilot_;
  const BoardConstants& board_;
  int cells_;
  double speed_;
  DriveCommand order_;
  HeldDirections keys_;
  viewer::GamepadInput gamepad_;
  viewer::Controls sticks_{false, 1.0};
  bool quit_ = false;
};

}  // namespace

void register_drive_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<DriveArguments>(
      root, program, "drive", "Drive a robot by keys or gamepad, its telemetry beside",
      [](const DriveArguments& given) {
        if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0)
          throw InputError("drive: keys come from a terminal, and here is none");
        catch_interrupts();
        return PersonDrives(given).run();
      });
  add_link_options(command, arguments.link);
  add_key_option(command, arguments.link);
  add_number(command, "--speed", arguments.speed_m_per_s, "Greatest speed [m/s]", {0.02, 1.0})
      ->show_default();
  add_number(command, "--turn", arguments.turn_deg_per_s, "Greatest turn rate [deg/s]",
             {5.0, 180.0})
      ->show_default();
  command.add_option("--log", arguments.log, "Append every frame to this candump log")
      ->type_name("FILE");
  command.add_option("--board", arguments.board, "Board of the robot, for the slip of tracks")
      ->type_name("NAME")
      ->show_default();
}

}  // namespace screed
