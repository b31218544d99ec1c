// `screed log summary LOG`: what a robot did, from its own telemetry: where it drove, what it spent
// its time on, what happened, and how well it was heard. Exit codes: 0, 2 wrong input.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host_sim/core/errors.h"
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
    Json json;
    json["duration_s"] = seconds_between(begin_us_.value_or(0), end_us_.value_or(0));
    json["algorithm"] = algorithm_.empty() ? Json(nullptr) : Json(algorithm_);
    json["path_m"] = path_m_;
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
      json["battery_v"] = {{"first", first_v_}, {"last", last_v_}, {"lowest", battery_v_.low}};
      const std::optional<double> charge = battery_charge(last_v_, cells);
      json["battery_v"]["charge"] = charge.has_value() ? Json(*charge) : Json(nullptr);
    }
    const auto or_null = [](const std::optional<double>& value) {
      return value.has_value() ? Json(*value) : Json(nullptr);
    };
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

std::string format(const char* pattern, double value) {
  char text[64];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

void print_times(const char* title, const Json& times) {
  double sum = 0.0;
  for (const auto& [name, s] : times.items()) sum += s.get<double>();
  std::string text;
  for (const auto& [name, s] : times.items()) {
    if (!text.empty()) text += ", ";
    text += name + format(" %.0f s", s.get<double>()) +
            format(" (%.0f %%)", 100.0 * s.get<double>() / std::max(sum, 1e-9));
  }
  std::printf("  %-12s %s\n", title, text.empty() ? "-" : text.c_str());
}

void print(const Json& robot, int cells) {
  const auto row = [](const char* name, const std::string& text) {
    std::printf("  %-12s %s\n", name, text.c_str());
  };
  row("duration", format("%.1f s", robot["duration_s"].get<double>()));
  row("algorithm", robot["algorithm"].is_null() ? "-" : robot["algorithm"].text());
  std::string path = format("%.2f m", robot["path_m"].get<double>());
  if (robot.contains("x_m")) {
    path += format(" by its own position, x %.2f", robot["x_m"][0].get<double>()) +
            format(" to %.2f, y", robot["x_m"][1].get<double>()) +
            format(" %.2f", robot["y_m"][0].get<double>()) +
            format(" to %.2f m", robot["y_m"][1].get<double>());
  }
  row("path", path);
  print_times("states", robot["states_s"]);
  print_times("running", robot["running_s"]);
  if (robot.contains("battery_v")) {
    const Json& battery = robot["battery_v"];
    row("battery", format("%.2f V at first, ", battery["first"].get<double>()) +
                       battery_text(battery["last"].get<double>(), cells) + " at the end, " +
                       format("%.2f V at least", battery["lowest"].get<double>()));
  }
  const auto slip = [&](const char* side) {
    const Json& value = robot["slip"][side];
    return value.is_null() ? std::string("-") : format("%.0f %%", 100.0 * value.get<double>());
  };
  row("slip", "left " + slip("left") + ", right " + slip("right") + " in the mean");
  const Json& link = robot["link"];
  row("link", std::to_string(link["frames"].get<uint64_t>()) + " frames, " +
                  format("%.1f %% lost, ", 100.0 * link["loss"].get<double>()) +
                  format("%.0f s silent", link["silent_s"].get<double>()));
  for (const Json& event : robot["events"])
    std::printf("  %9.1f s  %s\n", event["time_s"].get<double>(), event["text"].text().c_str());
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
    std::cout << json.dump(2, Json::BadText::kReplace) << "\n";
    return 0;
  }
  for (const Json& robot : json["robots"]) {
    std::printf("%s, %s\n", arguments.log.c_str(), robot["robot"].text().c_str());
    print(robot, cells);
  }
  if (counts.unreadable_lines + counts.damaged_frames > 0) {
    std::printf("%llu lines cannot be read, %llu frames are damaged\n",
                static_cast<unsigned long long>(counts.unreadable_lines),
                static_cast<unsigned long long>(counts.damaged_frames));
  }
  return 0;
}

}  // namespace

void register_log_command(Command& root, Program& program) {
  Command* log = root.add_subcommand("log", "Look at a robot's own telemetry log");
  Command* command = log->add_subcommand(
      "summary",
      "Print what a robot did: path, states, events and faults with times, battery, slip, link");
  const auto arguments = std::make_shared<LogArguments>();
  command->add_option("LOG", arguments->log, "Log as written by candump -L; -: standard input")
      ->required();
  command->add_option("--board", arguments->board, "Board of the robots, for slip and battery")
      ->type_name("NAME")
      ->show_default();
  command->add_flag("--json", arguments->json, "Print JSON");
  command->callback([arguments, &program] {
    program.action = [arguments] { return run_log_summary(*arguments); };
  });
}

}  // namespace screed
