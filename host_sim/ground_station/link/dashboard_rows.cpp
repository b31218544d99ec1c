// What the dashboard says of a robot.
#include "host_sim/ground_station/link/dashboard_rows.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "firmware/protocol/messages.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "host_sim/ground_station/telemetry/battery_charge.h"
#include "host_sim/ground_station/telemetry/track_slip.h"

namespace screed {
namespace {

constexpr uint64_t kOld_us = 1'000'000;

/// Makes rows of one robot at one time. A row belongs to the message that carries its value.
class RowMaker {
 public:
  RowMaker(const DashboardInput& input, const RobotHistory& robot) : input_(input), robot_(robot) {}

  DashboardRow row(int importance, const char* label, const char* message, std::string value,
                   CellStyle style = CellStyle::kNormal) const {
    const MessageInfo& carrier = *find_message(message);
    const std::optional<double> age_s = robot_.latest().age_s(carrier, input_.now_us);
    if (!age_s.has_value()) return {importance, label, "-", CellStyle::kDim};
    // Without a link a value is history at once.
    const bool old = !input_.link.up || is_old(robot_, carrier, input_.now_us);
    if (!old) return {importance, label, std::move(value), style};
    value += " (" + age_text(*age_s) + ")";
    return {importance, label, std::move(value), CellStyle::kDim};
  }

  /// A signal in its unit.
  DashboardRow signal(int importance, const char* label, const char* path) const {
    const SignalRef place = find_signal(path);
    const std::string unit = place.signal->unit;
    return row(importance, label, place.message->name,
               robot_.text(path) + (unit.empty() ? "" : " " + unit));
  }

  /// A signal with a bar that is full at `full` and warns from `warn` on.
  DashboardRow bar(int importance, const char* label, const char* path, double full,
                   double warn) const {
    DashboardRow made = signal(importance, label, path);
    const double value = robot_.value(path).value_or(0.0);
    if (made.style != CellStyle::kDim) made.bar = {value / full, std::abs(value) >= warn};
    return made;
  }

  bool flag(const char* path) const { return robot_.value(path).value_or(0.0) != 0.0; }

 private:
  const DashboardInput& input_;
  const RobotHistory& robot_;
};

DashboardRow battery_row(const DashboardInput& input, const RobotHistory& robot,
                         const RowMaker& make) {
  const double battery_v = robot.value("power.battery").value_or(0.0) * 1e-3;
  const std::optional<double> charge = battery_charge(battery_v, input.battery_cells);
  std::string text = battery_text(battery_v, input.battery_cells);
  // The robot knows its limit; the charge warns before.
  const bool below_limit = make.flag("heartbeat.battery");
  const bool low = charge.has_value() && *charge < kLowCharge;
  if (below_limit) text += "  TOO LOW";
  if (low && !below_limit) text += "  LOW";
  return make.row(1, "battery", "POWER", std::move(text),
                  below_limit ? CellStyle::kAlarm
                  : low       ? CellStyle::kWarning
                              : CellStyle::kNormal);
}

/// How well it knows where it is: standard deviations.
DashboardRow certainty_row(const RobotHistory& robot, const RowMaker& make) {
  return make.row(11, "certain to", "POSITION",
                  robot.text("position.sigma_x") + ", " + robot.text("position.sigma_y") + " mm, " +
                      robot.text("position.sigma_heading") + " deg");
}

/// Slip with the newest POSITION, from what was said in the second before.
std::optional<TrackSlip> newest_slip(const RobotHistory& robot, const BoardConstants& board) {
  const MessageInfo* const position = find_message("POSITION");
  if (robot.history(*position).empty()) return std::nullopt;
  const RobotHistory::Sample& newest = robot.history(*position).front();
  TrackSlipEstimate estimate(board);
  for (const char* name : {"ENCODERS", "ODOMETRY"}) {
    const MessageInfo& message = *find_message(name);
    const auto& samples = robot.history(message);  // the newest first
    const auto older = std::find_if(samples.begin(), samples.end(), [&](const auto& sample) {
      return sample.time_us + 2 * TrackSlipEstimate::kWindow_us < newest.time_us;
    });
    for (auto it = std::make_reverse_iterator(older); it != samples.rend(); ++it) {
      if (it->time_us <= newest.time_us)
        estimate.add(it->time_us, message, message_bits(it->data.data()));
    }
  }
  return estimate.add(newest.time_us, *position, message_bits(newest.data.data()));
}

DashboardRow slip_row(const DashboardInput& input, const RobotHistory& robot,
                      const RowMaker& make) {
  const auto text = [](const std::optional<double>& slip) {
    return slip.has_value() ? number("%.0f %%", *slip * 100.0) : "-";
  };
  const std::optional<TrackSlip> slip =
      input.board == nullptr ? std::nullopt : newest_slip(robot, *input.board);
  return make.row(8, kSlipLabel, "POSITION",
                  slip.has_value() ? text(slip->left) + ", " + text(slip->right) : "-");
}

DashboardGroup algorithm_group(const RobotHistory& robot, const RowMaker& make) {
  const bool stuck = make.flag("motors.stuck");
  const bool slips = make.flag("motors.slip");
  return {"algorithm",
          {make.row(11, "algorithm", "LEVELING", robot.text("leveling.algorithm")),
           make.row(2, "doing", "LEVELING",
                    robot.text("leveling.state") + (stuck   ? ", STUCK"
                                                    : slips ? ", tracks slip"
                                                            : ""),
                    stuck   ? CellStyle::kAlarm
                    : slips ? CellStyle::kWarning
                            : CellStyle::kTitle),
           make.row(5, "speed, turn", "LEVELING",
                    robot.text("leveling.speed") + " mm/s, " + robot.text("leveling.turn_rate") +
                        " deg/s"),
           make.row(16, "peaks", "LEVELING", robot.text("leveling.peaks"))}};
}

DashboardGroup link_group(const DashboardInput& input, const RobotHistory& robot,
                          const RowMaker& make) {
  const std::optional<double> loss = robot.loss_percent(input.now_us);
  const bool silent = link_lost(input, robot);
  const bool alive = make.flag("heartbeat.link_alive");
  const std::optional<double> quality = robot.value("link.quality");
  const std::optional<int> rssi_dbm = robot.rssi_dbm();
  return {"link",
          {{8, "down",
            number("%.0f frames/s, lost ", robot.frames_per_s(input.now_us)) +
                (loss.has_value() ? number("%.1f %%", *loss) : "-"),
            silent ? CellStyle::kAlarm : CellStyle::kNormal},
           make.row(3, "up", "HEARTBEAT",
                    !alive                 ? "no ground station heard"
                    : !quality.has_value() ? "alive"
                                           : number("alive, hears %.0f %%", *quality),
                    alive ? CellStyle::kGood : CellStyle::kAlarm),
           {14, "refused", refused_text(input)},
           {15, "strength", rssi_dbm.has_value() ? std::to_string(*rssi_dbm) + " dBm" : "-"}}};
}

/// Latched faults, or what keeps a disarmed robot from being armed.
DashboardGroup fault_group(const DashboardInput& input, const RobotHistory& robot) {
  const bool disarmed =
      robot.raw("heartbeat.state") == static_cast<int64_t>(message::HeartbeatState::kDisarmed);
  const std::vector<std::string> sentences =
      disarmed ? robot.obstacles(input.now_us) : robot.faults();
  DashboardGroup group{disarmed && !sentences.empty() ? "cannot be armed" : "faults", {}};
  const bool old = !input.link.up || is_old(robot, *find_message("HEARTBEAT"), input.now_us);
  const CellStyle style = old        ? CellStyle::kDim
                          : disarmed ? CellStyle::kWarning
                                     : CellStyle::kAlarm;
  for (const std::string& sentence : sentences) group.rows.push_back({0, "", sentence, style});
  if (sentences.empty()) {
    const CellStyle calm = old ? CellStyle::kDim : CellStyle::kGood;
    group.rows.push_back({10, "", disarmed ? "none; can be armed" : "none", calm});
  }
  return group;
}

}  // namespace

std::string number(const char* pattern, double value) {
  char text[48];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

bool link_lost(const DashboardInput& input, const RobotHistory& robot) {
  return !input.link.up || input.now_us > robot.last_us() + kOld_us;
}

bool is_old(const RobotHistory& robot, const MessageInfo& message, uint64_t now_us) {
  const LatestTelemetry::Frame* const last = robot.latest().frame(message);
  if (last == nullptr) return false;
  const uint64_t period_us = uint64_t{message.period_ms} * 1000U;
  return now_us > last->time_us + std::max(kOld_us, period_us + period_us / 2);
}

std::string age_text(double age_s) {
  if (age_s < 60.0) return number("%.0f s", std::floor(age_s));
  if (age_s < 3600.0) return number("%.0f min", std::floor(age_s / 60.0));
  return number("%.0f h", std::floor(age_s / 3600.0));
}

std::string refused_text(const DashboardInput& input) {
  return std::to_string(input.link.refused + input.fleet->damaged()) + " damaged, " +
         std::to_string(input.fleet->unknown()) + " unknown";
}

std::vector<DashboardGroup> dashboard_groups(const DashboardInput& input,
                                             const RobotHistory& robot) {
  const RowMaker make(input, robot);
  const double distance_m =
      std::hypot(robot.value("odometry.x").value_or(0.0), robot.value("odometry.y").value_or(0.0)) *
      1e-3;
  return {{"attitude",
           {make.bar(4, "roll", "attitude.roll", 45.0, 30.0),
            make.bar(4, "pitch", "attitude.pitch", 45.0, 30.0),
            make.signal(7, "heading", "attitude.heading")}},
          {"odometry",
           {make.signal(10, "x (east)", "odometry.x"), make.signal(10, "y (north)", "odometry.y"),
            make.row(9, "from start", "ODOMETRY", number("%.2f m", distance_m)),
            certainty_row(robot, make),
            make.row(13, "encoders", "ENCODERS",
                     robot.text("encoders.left") + "  " + robot.text("encoders.right"))}},
          {"motors",
           {make.bar(6, "left", "motors.duty_left", 100.0, 90.0),
            make.bar(6, "right", "motors.duty_right", 100.0, 90.0), slip_row(input, robot, make),
            battery_row(input, robot, make), make.signal(12, "CPU load", "power.cpu_load")}},
          algorithm_group(robot, make),
          link_group(input, robot, make),
          fault_group(input, robot)};
}

}  // namespace screed
