// `screed monitor`: what a robot says, live in a terminal or as text in a pipe, logged as candump
// does; and the ground station whose heartbeats keep the robot going.
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/link/dashboard.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "host_sim/ground_station/telemetry/candump_log.h"
#include "host_sim/run/experiment/board_table.h"
#include "tools/screed/cli/command.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/number_option.h"
#include "tools/screed/cli/terminal_screen.h"
#include "tools/screed/link/named_parameters.h"
#include "tools/screed/link/robot_link.h"

namespace screed {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kMonitorPump{50};
constexpr uint64_t kPlainPeriod_us = 1'000'000;
constexpr uint64_t kMonitorTimeout_us = 5'000'000;
constexpr int kTabKey = '\t';

struct MonitorArguments {
  LinkArguments link;
  std::optional<std::string> log;
  std::vector<std::string> curves = {"attitude.pitch", "leveling.speed", "gyro_raw.z"};
  std::string board = kDefaultBoard;
  std::optional<int> cells;
  double duration_s = 0.0;
  bool listen = false;
  bool plain = false;
  bool once = false;
};

class Monitor {
 public:
  explicit Monitor(const MonitorArguments& arguments)
      : arguments_(arguments),
        link_(open_link(arguments.link)),
        session_(*link_, {command_key(arguments.link),
                          !arguments.listen,
                          [this](const LinkFrame& frame) { on_frame(frame); },
                          {}}),
        curves_(arguments.curves),
        cells_(arguments.cells.has_value() ? *arguments.cells
                                           : board_battery_cells(arguments.board)),
        board_(board_constants_of(arguments.board)),
        begin_us_(wall_clock_us()) {
    for (const std::string& path : curves_) find_signal(path);
    if (arguments.log.has_value()) log_.emplace(*arguments.log, link_->name());
  }

  int run() {
    const bool plain = arguments_.plain || arguments_.once || isatty(STDOUT_FILENO) == 0;
    if (plain) {
      run_plain();
    } else {
      run_screen();
    }
    if (log_.has_value()) log_->check();
    return fleet_.robots().empty() ? 1 : 0;
  }

 private:
  bool over() const {
    if (interrupted()) return true;
    const uint64_t passed_us = wall_clock_us() - begin_us_;
    if (arguments_.duration_s > 0.0)
      return static_cast<double>(passed_us) >= arguments_.duration_s * 1e6;
    // One report: a second after the first word, but no waiting for ever.
    return arguments_.once && (passed_us >= kMonitorTimeout_us ||
                               (heard_us_ != 0 && wall_clock_us() >= heard_us_ + kPlainPeriod_us));
  }

  void on_frame(const LinkFrame& frame) {
    if (log_.has_value()) log_->add(frame.time_us, frame.frame);
    RobotHistory* const robot = fleet_.add_frame(frame);
    if (robot != nullptr && heard_us_ == 0) heard_us_ = wall_clock_us();
    if (robot != nullptr && !fleet_.robots().contains(robot_))
      robot_ = fleet_.robots().begin()->first;
  }

  DashboardInput input() const {
    DashboardInput input;
    input.now_us = wall_clock_us();
    input.link_name = link_->name();
    input.link = link_->status();
    input.fleet = &fleet_;
    input.robot = robot_;
    input.curves = curves_;
    input.window_s = window_s_;
    input.battery_cells = cells_;
    input.board = &board_;
    input.footer = {std::string(kEmergencyStopKeyName) + " emergency stop",
                    "a arm",
                    "r run",
                    "s stop",
                    "d disarm",
                    "c clear",
                    "q quit",
                    "p curve",
                    "+/- time"};
    if (arguments_.log.has_value()) input.footer.push_back("log: " + *arguments_.log);
    return input;
  }

  void run_plain() {
    uint64_t due_us = begin_us_ + kPlainPeriod_us;
    std::string link_text;  // the first one is said as well: from then on nothing is missed
    while (!over()) {
      session_.pump(kMonitorPump);
      if (!arguments_.once && link_->status().text != link_text) {
        link_text = link_->status().text;
        std::cout << "link " << link_->name() << " is " << link_text << std::endl;
      }
      if (arguments_.once || wall_clock_us() < due_us) continue;
      due_us += kPlainPeriod_us;
      std::cout << plain_report(input()) << std::flush;
    }
    if (arguments_.once) std::cout << plain_report(input()) << std::flush;
  }

  void run_screen() {
    TerminalScreen screen;
    bool quit = false;
    std::string link_text = link_->status().text;
    while (!quit && !over()) {
      session_.pump(kMonitorPump);
      if (link_->status().text != link_text) {
        link_text = link_->status().text;
        note(link_->status().up ? CellStyle::kGood : CellStyle::kAlarm, "link: " + link_text);
      }
      follow_command();
      while (const std::optional<int> key = screen.key()) quit = quit || !press(*key);
      TextCanvas page = screen.page();
      draw_dashboard(page, input());
      screen.show(page);
    }
  }

  void note(CellStyle style, const std::string& words) {
    const auto robot = fleet_.robots().find(robot_);
    if (robot != fleet_.robots().end()) robot->second.note(wall_clock_us(), style, words);
  }

  /// The robot's own answers are in its list; here is what it cannot say. One that names a fault
  /// shows that the key is right: the limits that the fault is about are read.
  void follow_command() {
    if (session_.waiting()) return;
    const std::optional<CommandAnswer> answer = session_.take_answer();
    if (commanded_ && !answer.has_value()) note(CellStyle::kAlarm, "no answer to the command");
    commanded_ = false;
    const auto robot = fleet_.robots().find(robot_);
    if (!answer.has_value() || robot == fleet_.robots().end()) return;
    if (answer->result == static_cast<uint8_t>(message::CommandAckResult::kFaultPresent))
      asked_faults_ = answer->detail;
    const auto limits = limits_to_read(asked_faults_, robot->second.latest());
    if (limits.empty()) {
      asked_faults_ = 0;
    } else {
      session_.start(CommandOp::kParameterRead, parameter_index(std::string(limits.front())));
    }
  }

  void command(CommandOp op) {
    session_.start(op);
    commanded_ = true;
  }

  /// False: quit.
  bool press(int key) {
    switch (key) {
      case 'q':
        return false;
      case 'a':
        command(CommandOp::kArm);
        break;
      case 'r':
        command(CommandOp::kRun);
        break;
      case 's':
        command(CommandOp::kStop);
        break;
      case 'd':
        command(CommandOp::kDisarm);
        break;
      case 'c':
        command(CommandOp::kClear);
        break;
      case kEmergencyStopKey:
        session_.emergency_stop();
        note(CellStyle::kAlarm, "emergency stop sent");
        break;
      case '+':
        window_s_ = std::max(window_s_ / 2.0, 7.5);
        break;
      case '-':
        window_s_ = std::min(window_s_ * 2.0, 120.0);
        break;
      case 'p':
        next_curve();
        break;
      case kTabKey:
        next_robot();
        break;
      default:
        break;
    }
    return true;
  }

  /// The first curve goes through all signals.
  void next_curve() {
    std::vector<std::string> paths;
    for (const MessageInfo& message : messages()) {
      for (const SignalInfo& signal : message.signals) {
        if (!message.uplink && signal.role == SignalRole::kData && signal.flags[0] == '\0')
          paths.push_back(std::string(message.title) + "." + signal.name);
      }
    }
    if (curves_.empty()) curves_.push_back(paths.back());
    const auto now = std::find(paths.begin(), paths.end(), curves_.front());
    curves_.front() = now == paths.end() || now + 1 == paths.end() ? paths.front() : *(now + 1);
  }

  void next_robot() {
    auto next = fleet_.robots().upper_bound(robot_);
    if (next == fleet_.robots().end()) next = fleet_.robots().begin();
    if (next != fleet_.robots().end()) robot_ = next->first;
  }

  const MonitorArguments& arguments_;
  std::unique_ptr<Link> link_;
  std::optional<CandumpWriter> log_;
  FleetView fleet_;
  RobotKey robot_;
  CommandSession session_;
  std::vector<std::string> curves_;
  int cells_;
  const BoardConstants& board_;
  double window_s_ = 30.0;
  uint64_t begin_us_;
  uint64_t heard_us_ = 0;  ///< when the first robot was heard; 0: none yet
  bool commanded_ = false;
  uint16_t asked_faults_ = 0;  ///< whose limits are being read
};

}  // namespace

void register_monitor_command(Command& root, Program& program) {
  auto [command, arguments] = add_subcommand<MonitorArguments>(
      root, program, "monitor",
      "Show a robot's telemetry live and send it heartbeats as its ground station",
      [](const MonitorArguments& given) {
        catch_interrupts();
        return Monitor(given).run();
      });
  add_link_options(command, arguments.link);
  add_key_option(command, arguments.link);
  command.add_option("--log", arguments.log, "Append every frame to this candump log")
      ->type_name("FILE");
  command
      .add_option("--curves", arguments.curves,
                  "Signals to draw, e.g. attitude.pitch,motors.duty_left")
      ->delimiter(',');
  command.add_option("--board", arguments.board, "Board of the robots, for the slip of tracks")
      ->type_name("NAME")
      ->show_default();
  add_number(
      command, "--cells", arguments.cells,
      "NiMH cells of the robot's battery in series, for its charge in per cent; 0: not shown "
      "(default: the battery of the board's robot)",
      {0, 20});
  command.add_flag("--listen", arguments.listen,
                   "Send no heartbeats: another ground station is in charge");
  command.add_flag("--plain", arguments.plain,
                   "Print one text report per second instead of a full-screen page (default "
                   "without a terminal)");
  command.add_flag("--once", arguments.once, "Print one report and exit");
  add_number(command, "--duration", arguments.duration_s, "Exit after this time [s]; 0: never",
             {0.0, 1e9});
}

}  // namespace screed
