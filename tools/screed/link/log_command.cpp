// `screed log summary LOG`: what a robot did, from its own telemetry: where it drove, what it spent
// its time on, what happened, and how well it was heard. Exit codes: 0, 2 wrong input.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
#include "host_sim/core/figures.h"
#include "host_sim/core/json.h"
#include "host_sim/ground_station/link/robot_history.h"
#include "host_sim/ground_station/telemetry/battery_charge.h"
#include "host_sim/ground_station/telemetry/track_slip.h"
#include "host_sim/run/experiment/board_table.h"
#include "tools/screed/cli/command.h"

namespace screed {
namespace {

// Between two messages of 5 Hz no robot drives as far: the origin was moved, or a fix came.
constexpr double kJump_m = 0.4;
// A robot that says nothing for longer was out of reach, or off.
constexpr double kSilent_s = 2.0;

double seconds_between(uint64_t from_us, uint64_t to_us) {
  return to_us < from_us ? 0.0 : static_cast<double>(to_us - from_us) * 1e-6;
}

struct Range {
  double low = INFINITY;
  double high = -INFINITY;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
};

class Mean {
 public:
  void add(double value) {
    sum_ += value;
    ++count_;
  }
  std::optional<double> value() const {
    return count_ == 0 ? std::nullopt : std::optional(sum_ / static_cast<double>(count_));
  }

 private:
  double sum_ = 0.0;
  uint64_t count_ = 0;
};

/// Of one robot, message by message.
class DriveSummary {
 public:
  explicit DriveSummary(const BoardConstants& board) : slip_(board) {}

  void add(const RobotLogFrame& it) {
    const RobotHistory& robot = it.robot;
    const uint64_t now_us = it.frame.time_us;
    frames_ = robot.frames();
    lost_ = robot.lost();
    if (!begin_us_.has_value()) begin_us_ = now_us;
    const double silent_s = seconds_between(end_us_.value_or(now_us), now_us);
    if (silent_s > kSilent_s) silent_s_ += silent_s;
    end_us_ = now_us;
    const std::string_view name = it.message.name;
    if (name == "ODOMETRY") {
      add_place(*robot.value("odometry.x") * 1e-3, *robot.value("odometry.y") * 1e-3);
    } else if (name == "HEARTBEAT") {
      spend(states_, state_, robot.text("heartbeat.state"), now_us);
    } else if (name == "LEVELING") {
      if (robot.text("heartbeat.state") == "running")
        spend(activities_, activity_, robot.text("leveling.state"), now_us);
      algorithm_ = robot.text("leveling.algorithm");
    } else if (name == "POWER") {
      const double volts = *robot.value("power.battery") * 1e-3;
      if (battery_v_.empty()) first_v_ = volts;
      last_v_ = volts;
      battery_v_.add(volts);
    }
    const uint64_t bits = message_bits(frame_bytes(it.frame.frame).data());
    if (const auto slip = slip_.add(now_us, it.message, bits); slip.has_value()) {
      if (slip->left.has_value()) slip_left_.add(std::abs(*slip->left));
      if (slip->right.has_value()) slip_right_.add(std::abs(*slip->right));
    }
    take_events(robot);
  }

  Json json(int cells) const {
    const auto or_null = [](const auto& value) {
      return value.has_value() ? Json(*value) : Json();
    };
    Json json = {{"duration_s", seconds_between(begin_us_.value_or(0), end_us_.value_or(0))},
                 {"algorithm", algorithm_.empty() ? Json() : Json(algorithm_)},
                 {"path_m", path_m_}};
    if (!x_m_.empty()) {
      json["x_m"] = {x_m_.low, x_m_.high};
      json["y_m"] = {y_m_.low, y_m_.high};
      json["end_m"] = {last_x_m_, last_y_m_};
    }
    json["states_s"] = Json::object();
    for (const auto& [name, s] : states_) json["states_s"][name] = s;
    json["running_s"] = Json::object();
    for (const auto& [name, s] : activities_) json["running_s"][name] = s;
    if (!battery_v_.empty()) {
      json["battery_v"] = {{"first", first_v_},
                           {"last", last_v_},
                           {"lowest", battery_v_.low},
                           {"charge", or_null(battery_charge(last_v_, cells))}};
    }
    json["slip"] = {{"left", or_null(slip_left_.value())}, {"right", or_null(slip_right_.value())}};
    json["link"] = {{"frames", frames_},
                    {"lost", lost_},
                    {"loss", static_cast<double>(lost_) / static_cast<double>(frames_ + lost_)},
                    {"silent_s", silent_s_}};
    json["events"] = Json::array();
    for (const RobotHistory::Event& event : events_) {
      json["events"].push_back(
          {{"time_s", seconds_between(*begin_us_, event.time_us)}, {"text", event.words}});
    }
    return json;
  }

 private:
  struct Spent {
    std::string name;
    uint64_t since_us = 0;
  };

  void add_place(double x_m, double y_m) {
    if (!x_m_.empty()) {
      const double step_m = std::hypot(x_m - last_x_m_, y_m - last_y_m_);
      if (step_m < kJump_m) path_m_ += step_m;
    }
    last_x_m_ = x_m;
    last_y_m_ = y_m;
    x_m_.add(x_m);
    y_m_.add(y_m);
  }

  /// The time since the last message of its kind was spent on what that one said.
  static void spend(std::map<std::string, double>& on, Spent& last, const std::string& name,
                    uint64_t now_us) {
    const double passed_s = seconds_between(last.since_us, now_us);
    if (!last.name.empty() && passed_s <= kSilent_s) on[last.name] += passed_s;
    last = {name, now_us};
  }

  /// Those that are new in the robot's list, which is bounded.
  void take_events(const RobotHistory& robot) {
    std::vector<RobotHistory::Event> fresh;
    for (const RobotHistory::Event& event : robot.events()) {
      if (!events_.empty() && event.time_us == events_.back().time_us &&
          event.words == events_.back().words)
        break;
      fresh.push_back(event);
    }
    events_.insert(events_.end(), fresh.rbegin(), fresh.rend());
  }

  std::optional<uint64_t> begin_us_;
  std::optional<uint64_t> end_us_;
  std::string algorithm_;
  double path_m_ = 0.0;
  Range x_m_;
  Range y_m_;
  double last_x_m_ = 0.0;
  double last_y_m_ = 0.0;
  std::map<std::string, double> states_;
  std::map<std::string, double> activities_;
  Spent state_;
  Spent activity_;
  Range battery_v_;
  double first_v_ = 0.0;
  double last_v_ = 0.0;
  TrackSlipEstimate slip_;
  Mean slip_left_;
  Mean slip_right_;
  uint64_t frames_ = 0;
  uint64_t lost_ = 0;
  double silent_s_ = 0.0;
  std::vector<RobotHistory::Event> events_;  ///< oldest first
};

struct LogArguments {
  std::string log;
  std::string board = kDefaultBoard;
  bool json = false;
};

std::string times_text(const Json& times) {
  double sum = 0.0;
  for (const auto& [name, s] : times.items()) sum += s.get<double>();
  std::string text;
  for (const auto& [name, s] : times.items()) {
    text += (text.empty() ? "" : ", ") + filled("{} {:.0f} s ({:.0f} %)", name, s,
                                                100.0 * s.get<double>() / std::max(sum, 1e-9));
  }
  return text.empty() ? "-" : text;
}

void print_drive(const Json& robot, int cells) {
  const auto row = [&](const char* name, const std::string& text) {
    print("  {:-12s} {}\n", name, filled(text, robot));
  };
  row("duration", "{duration_s:.1f} s");
  row("algorithm", robot["algorithm"].is_null() ? "-" : "{algorithm}");
  row("path", robot.contains("x_m") ? "{path_m:.2f} m by its own position, x {x_m.0:.2f} to "
                                      "{x_m.1:.2f}, y {y_m.0:.2f} to {y_m.1:.2f} m"
                                    : "{path_m:.2f} m");
  row("states", times_text(robot["states_s"]));
  row("running", times_text(robot["running_s"]));
  if (robot.contains("battery_v")) {
    row("battery", "{battery_v.first:.2f} V at first, " +
                       battery_text(robot["battery_v"]["last"].get<double>(), cells) +
                       " at the end, {battery_v.lowest:.2f} V at least");
  }
  const auto slip = [&](const char* side) {
    const Json& value = robot["slip"][side];
    return value.is_null() ? "-" : filled("{*100:.0f} %", value);
  };
  row("slip", "left " + slip("left") + ", right " + slip("right") + " in the mean");
  row("link", "{link.frames} frames, {link.loss*100:.1f} % lost, {link.silent_s:.0f} s silent");
  for (const Json& event : robot["events"]) print("  {time_s:9.1f} s  {text}\n", event);
}

int run_log_summary(const LogArguments& arguments) {
  const BoardConstants& board = board_constants_of(arguments.board);
  const int cells = board_battery_cells(arguments.board);
  std::map<RobotKey, DriveSummary> summaries;
  const RobotLogCounts counts = read_robot_log(arguments.log, [&](const RobotLogFrame& it) {
    summaries.try_emplace(it.key, board).first->second.add(it);
  });
  Json json = {{"log", arguments.log},
               {"unreadable_lines", counts.unreadable_lines},
               {"damaged_frames", counts.damaged_frames},
               {"robots", Json::array()}};
  for (const auto& [key, summary] : summaries) {
    Json robot = summary.json(cells);
    robot["robot"] = key.text();
    json["robots"].push_back(robot);
  }
  if (arguments.json) {
    print_json(json);
    return 0;
  }
  for (const Json& robot : json["robots"]) {
    print("{}, {}\n", arguments.log, robot["robot"]);
    print_drive(robot, cells);
  }
  if (counts.unreadable_lines + counts.damaged_frames > 0)
    print("{unreadable_lines} lines cannot be read, {damaged_frames} frames are damaged\n", json);
  return 0;
}

}  // namespace

void register_log_command(Command& root, Program& program) {
  Command* log = root.add_subcommand("log", "Look at a robot's own telemetry log");
  auto [command, arguments] = add_subcommand<LogArguments>(
      *log, program, "summary",
      "Print what a robot did: path, states, events and faults with times, battery, slip, link",
      run_log_summary);
  command.add_option("LOG", arguments.log, "Log as written by candump -L; -: standard input")
      ->required();
  command.add_option("--board", arguments.board, "Board of the robots, for slip and battery")
      ->type_name("NAME")
      ->show_default();
  command.add_flag("--json", arguments.json, "Print JSON");
}

}  // namespace screed
