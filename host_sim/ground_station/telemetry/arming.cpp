// Why a robot cannot be armed.
#include "host_sim/ground_station/telemetry/arming.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>

#include "firmware/estimation/attitude.h"
#include "firmware/parameters/parameters.h"
#include "firmware/protocol/messages.h"
#include "hal/sample.h"

namespace screed {
namespace {

using Fault = message::HeartbeatFaults;
using State = message::HeartbeatState;
using Result = message::CommandAckResult;

constexpr double kDegrees = 180.0 / std::numbers::pi;

template <class... Values>
std::string format(const char* pattern, Values... values) {
  char text[128];
  std::snprintf(text, sizeof text, pattern, values...);
  return text;
}

/// A fault whose cause is a measurement beyond a limit that is a parameter.
struct LimitedFault {
  uint16_t bit;
  const char* parameter;
};
constexpr LimitedFault kLimitedFaults[] = {{Fault::kTilt, "tilt_limit"},
                                           {Fault::kBattery, "battery_low"}};

/// A limit, and whether the robot itself has told it; else it is the default.
struct Limit {
  double value;  ///< in units of the parameter
  bool reported;

  /// In a sentence: the robot may have been given another one.
  std::string text(const std::string& number) const {
    return number + (reported ? "" : " (the default)");
  }
};

Limit limit_of(const LatestTelemetry& robot, std::string_view parameter) {
  if (const std::optional<int32_t> reported = robot.parameter(parameter))
    return {static_cast<double>(*reported), true};
  const auto* const info =
      std::find_if(std::begin(kParameterTable), std::end(kParameterTable),
                   [parameter](const ParameterInfo& it) { return it.name == parameter; });
  return {static_cast<double>(info->default_value), false};
}

/// By the estimator, or by the accelerometer where that says more: the supervisor hears both.
std::optional<double> inclination_deg(const LatestTelemetry& robot) {
  std::optional<double> most;
  const auto consider = [&most](double cosine) {
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees;
    most = std::max(angle, most.value_or(0.0));
  };
  const std::optional<double> roll = robot.value("attitude.roll");
  const std::optional<double> pitch = robot.value("attitude.pitch");
  if (roll.has_value() && pitch.has_value())
    consider(std::cos(*roll / kDegrees) * std::cos(*pitch / kDegrees));
  const std::optional<double> x = robot.value("accel_raw.x");
  const std::optional<double> y = robot.value("accel_raw.y");
  const std::optional<double> z = robot.value("accel_raw.z");
  if (x.has_value() && y.has_value() && z.has_value()) {
    const double length = std::hypot(*x, *y, *z);
    if (length > 0.0) consider(*z / length);
  }
  return most;
}

// A latched fault may outlive its cause, and a limit that is not known may be another than the
// default: a measurement is only said to be beyond a limit when it is.

std::string tilt_sentence(const LatestTelemetry& robot) {
  const Limit limit = limit_of(robot, "tilt_limit");
  const double limit_deg = limit.value / 100.0;
  const std::string name = "tilt_limit " + limit.text(format("%.0f degrees", limit_deg));
  const std::optional<double> measured_deg = inclination_deg(robot);
  if (!measured_deg.has_value()) return "tilted beyond " + name;
  const std::string measured = format("%.0f degrees", *measured_deg);
  if (*measured_deg >= limit_deg) return "tilted " + measured + ", " + name;
  return "tilted beyond tilt_limit, " + measured + " now";
}

std::string battery_sentence(const LatestTelemetry& robot) {
  const Limit limit = limit_of(robot, "battery_low");
  const std::string name = "battery_low " + limit.text(format("%.2f V", limit.value / 1000.0));
  const std::optional<double> measured_mv = robot.value("power.battery");
  if (!measured_mv.has_value()) return "battery below " + name;
  const std::string measured = format("%.2f V", *measured_mv / 1000.0);
  if (*measured_mv < limit.value) return "battery " + measured + " below " + name;
  return "battery below battery_low, " + measured + " now";
}

std::string sentence_of(const SignalInfo& flag, uint16_t bit, const LatestTelemetry& robot) {
  if (bit == Fault::kTilt) return tilt_sentence(robot);
  if (bit == Fault::kBattery) return battery_sentence(robot);
  return flag_text(flag);
}

}  // namespace

std::vector<std::string> fault_sentences(uint16_t faults, const LatestTelemetry& robot) {
  std::vector<std::string> sentences;
  for (const FlagInfo& flag : flags_of("heartbeat", "faults")) {
    if ((faults & flag.bit) != 0)
      sentences.push_back(sentence_of(*flag.signal, static_cast<uint16_t>(flag.bit), robot));
  }
  return sentences;
}

std::string start_up_sentence(const LatestTelemetry& robot, uint64_t now_us) {
  constexpr double kNeeded_s =
      static_cast<double>(AttitudeEstimator::kStartTicks + AttitudeEstimator::kRestTicks) /
      kTickRate_hz;
  std::string needed = format("start-up needs %.1f s at rest", kNeeded_s);
  const std::optional<double> said_ms = robot.value("time.time");
  if (!said_ms.has_value()) return needed;
  const double age_s = robot.age_s(*find_message("TIME"), now_us).value_or(0.0);
  const double left_s = kNeeded_s - *said_ms * 1e-3 - age_s;
  // A robot that was moved takes longer than that.
  if (left_s < 0.05) return needed + "; keep the robot still";
  return needed + format(", %.1f s left", left_s);
}

std::optional<std::string> gate_refusal(uint8_t result, uint16_t detail) {
  switch (static_cast<Result>(result)) {
    case Result::kNoKey:
      return "the robot has no command key; one is set over USB";
    case Result::kBadMac:
      return "signed with another key than the robot's (--key)";
    case Result::kLockedOut:
      return format("too many wrong signatures; locked for %.0f s",
                    std::ceil(static_cast<double>(detail) / kTickRate_hz));
    case Result::kUsedUp:
      return "the robot has taken all commands of this start; restart it";
    default:
      return std::nullopt;
  }
}

std::vector<std::string_view> limits_to_read(uint16_t faults, const LatestTelemetry& robot) {
  std::vector<std::string_view> names;
  for (const LimitedFault& limited : kLimitedFaults) {
    if ((faults & limited.bit) != 0 && !robot.parameter(limited.parameter).has_value())
      names.emplace_back(limited.parameter);
  }
  return names;
}

std::vector<std::string> arming_obstacles(const LatestTelemetry& robot, uint64_t now_us) {
  const LatestTelemetry::Frame* const heartbeat = robot.frame(*find_message("HEARTBEAT"));
  if (heartbeat == nullptr) return {};
  const auto said = message::Heartbeat::unpack(heartbeat->data.data());
  const auto state = static_cast<State>(said.state);
  if (state != State::kDisarmed && state != State::kFault) return {};

  std::vector<std::string> obstacles = fault_sentences(said.faults, robot);
  if (state == State::kFault) {
    obstacles.emplace_back("the fault is latched until it is cleared");
    return obstacles;
  }
  // No heartbeat shows what the gate thinks of the ground's key: the last answer does.
  if (const LatestTelemetry::Frame* const last = robot.frame(*find_message("COMMAND_ACK"))) {
    const auto answer = message::CommandAck::unpack(last->data.data());
    if (const auto refusal = gate_refusal(answer.result, answer.detail))
      obstacles.push_back("commands are refused: " + *refusal);
  }
  if (said.link_alive == 0 && robot.parameter("standalone").value_or(0) == 0)
    obstacles.emplace_back("the robot hears no ground station");
  if (robot.value("health.starting").value_or(0.0) != 0.0)
    obstacles.push_back(start_up_sentence(robot, now_us));
  return obstacles;
}

}  // namespace screed
