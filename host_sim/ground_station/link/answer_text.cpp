// A robot's answer to a command, in words.
#include "host_sim/ground_station/link/answer_text.h"

#include <optional>
#include <vector>

#include "firmware/protocol/messages.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {
namespace {

using Result = message::CommandAckResult;
using State = message::HeartbeatState;

std::string joined(const std::vector<std::string>& sentences) {
  std::string text;
  for (const std::string& sentence : sentences) {
    if (!text.empty()) text += "; ";
    text += sentence;
  }
  return text;
}

/// The command that leads out of a state towards one in which `op` is possible.
std::optional<CommandOp> step_before(CommandOp op, State state) {
  if (op == CommandOp::kClear) return std::nullopt;
  if (state == State::kFault) return CommandOp::kClear;
  const bool needs_armed = op == CommandOp::kRun || op == CommandOp::kDrive;
  if (needs_armed && state == State::kDisarmed) return CommandOp::kArm;
  if (op == CommandOp::kDrive && state != State::kRunning) return CommandOp::kRun;
  if (op == CommandOp::kParameterCommit && state != State::kDisarmed) return CommandOp::kDisarm;
  return std::nullopt;
}

/// "arm first: screed send arm", "arm first (key a)".
std::string remedy(CommandOp step, CommandStyle style) {
  const std::string name = find_signal("command.op").signal->text(static_cast<int64_t>(step));
  const std::string what = step == CommandOp::kClear ? "clear it first" : name + " first";
  // The monitor's keys are the commands' first letters.
  if (style == CommandStyle::kKeys) return what + " (key " + name.substr(0, 1) + ")";
  return what + ": screed send " + name;
}

std::string state_text(State state, const LatestTelemetry& robot) {
  std::string text = robot.text("heartbeat.state");
  if (state != State::kFault) return text;
  const auto* const heartbeat = robot.frame(*find_message("HEARTBEAT"));
  const uint16_t faults = message::Heartbeat::unpack(heartbeat->data.data()).faults;
  return text + " (" + joined(fault_sentences(faults, robot)) + ")";
}

/// A command that the state does not allow.
std::string wrong_state_text(CommandOp op, const LatestTelemetry& robot, CommandStyle style) {
  const std::optional<int64_t> number = robot.raw("heartbeat.state");
  if (!number.has_value()) return "not possible in the robot's present state";
  const auto state = static_cast<State>(*number);
  const std::string now = state_text(state, robot);
  if (const std::optional<CommandOp> step = step_before(op, state))
    return now + "; " + remedy(*step, style);
  switch (op) {
    case CommandOp::kArm:
    case CommandOp::kRun:
      return now + " already";
    case CommandOp::kStop:
      return now + "; only a running robot can be stopped";
    case CommandOp::kClear:
      return now + "; there is no fault to clear";
    case CommandOp::kDrive:
      if (robot.text("leveling.algorithm") == "drive")
        return "it was not running yet, and is now; send it again";
      return now + " the algorithm '" + robot.text("leveling.algorithm") +
             "'; set the parameter algorithm to drive first";
    default:
      return "not possible while " + now;
  }
}

}  // namespace

std::string refusal_text(const CommandAnswer& answer, const LatestTelemetry& robot, uint64_t now_us,
                         CommandStyle style) {
  switch (static_cast<Result>(answer.result)) {
    case Result::kDone:
      return "";
    case Result::kWrongState:
      return wrong_state_text(static_cast<CommandOp>(answer.op), robot, style);
    case Result::kFaultPresent:
      return joined(fault_sentences(answer.detail, robot));
    case Result::kNotReady:
      return start_up_sentence(robot, now_us);
    case Result::kNoLink:
      return "the robot hears no ground station (screed monitor, or screed send --hold)";
    case Result::kBadArgument:
      return "no such parameter, or the value is not allowed";
    case Result::kBusy:
      return "the robot is still storing the last parameter";
    default:
      return gate_refusal(answer.result, answer.detail)
          .value_or("reason " + std::to_string(answer.result));
  }
}

std::string answer_text(const CommandAnswer& answer, const LatestTelemetry& robot, uint64_t now_us,
                        CommandStyle style) {
  return answer.done() ? "done" : "refused: " + refusal_text(answer, robot, now_us, style);
}

}  // namespace screed
