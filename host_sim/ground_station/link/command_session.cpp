// Commands, and answers in words.
#include "host_sim/ground_station/link/command_session.h"

#include <optional>
#include <utility>
#include <vector>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "firmware/security/command_mac.h"
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

// A ground station's side of a link.

namespace {

using Result = message::CommandAckResult;

constexpr std::chrono::milliseconds kPump{20};
/// The robot stores a parameter for 2 s and takes no other meanwhile.
constexpr int kMaxBusyAnswers = 12;
constexpr int kMaxStagings = 3;

uint64_t steady_us() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now).count());
}

}  // namespace

CommandSession::CommandSession(Link& link, SessionOptions options)
    : link_(link), options_(std::move(options)), signer_(options_.key) {
  if (!options_.clock) options_.clock = steady_us;
}

void CommandSession::send_protected(CanFrame frame, uint8_t& counter) {
  e2e_protect(frame.id, counter, frame.data, frame.size);
  counter = static_cast<uint8_t>((counter + 1) & 0x0F);
  link_.send(frame);
}

void CommandSession::pump(std::chrono::milliseconds wait) {
  frames_.clear();
  link_.receive(wait, frames_);
  for (const LinkFrame& frame : frames_) {
    if (check_frame(frame.frame) == FrameFault::kNone) handle_frame(frame.frame);
    if (options_.on_frame) options_.on_frame(frame);
  }
  const uint64_t now_us = options_.clock();
  if (options_.heartbeats && now_us >= heartbeat_due_us_) {
    const message::GroundHeartbeat heartbeat = {static_cast<uint32_t>(now_us / 1000U)};
    send_protected(frame_of(heartbeat), heartbeat_counter_);
    heartbeat_due_us_ = now_us + kHeartbeat_us;
  }
  if (waiting_ && now_us >= repeat_due_us_) {
    repeat_due_us_ = now_us + kRepeat_us;
    if (attempts_++ == kMaxAttempts) {
      waiting_ = false;
    } else if (signer_.ready()) {
      send_command();
    }
  }
}

void CommandSession::start(CommandOp op, uint32_t argument) {
  op_ = op;
  argument_ = argument;
  command_.reset();
  staged_.reset();
  answer_.reset();
  waiting_ = true;
  attempts_ = 0;
  repeat_due_us_ = 0;
}

void CommandSession::send_command() {
  if (!command_.has_value()) {
    command_ = signer_.sign(op_, argument_);
    signed_ = signer_.counter();
  }
  if (staged_.has_value()) send_protected(*staged_, stage_counter_);
  link_.send(*command_);
}

void CommandSession::handle_frame(const CanFrame& frame) {
  signer_.handle_frame(frame);
  const uint16_t id = exchange_node_1(frame.id, node());
  if (id == kIdParamValue) {
    const auto value = message::ParamValue::unpack(frame.data);
    parameters_[value.index] = value.value;
  }
  if (id != kIdCommandAck || !waiting_ || !command_.has_value()) return;
  const auto ack = message::CommandAck::unpack(frame.data);
  const bool same_number = ack.freshness == command_->data[kCommandFreshnessOffset];
  const bool is_own = same_number && ack.op == command_->data[0];
  const bool bad_mac = static_cast<Result>(ack.result) == Result::kBadMac;
  // Where somebody else's command with this number, or a later one, was taken, this one never is.
  const bool late = is_own ? bad_mac && ack.detail >= signed_
                           : (same_number && !bad_mac) || signer_.counter() > signed_;
  if (late) {
    command_.reset();
    repeat_due_us_ = 0;
  }
  if (late || !is_own) return;
  answer_ = {ack.op, ack.result, ack.detail};
  waiting_ = false;
}

std::optional<CommandAnswer> CommandSession::take_answer() {
  return std::exchange(answer_, std::nullopt);
}

void CommandSession::wait() {
  if (options_.on_wait) options_.on_wait();
  pump(kPump);
}

std::optional<CommandAnswer> CommandSession::run(CommandOp op, uint32_t argument) {
  start(op, argument);
  while (waiting_) wait();
  return take_answer();
}

std::optional<int32_t> CommandSession::read_parameter(uint16_t index,
                                                      std::optional<CommandAnswer>& answer) {
  parameters_.erase(index);
  answer = run(CommandOp::kParameterRead, index);
  // The value is a frame of its own, which may come after the answer, or be lost.
  for (int again = 0; answer.has_value() && answer->done() && again < kMaxStagings; ++again) {
    const uint64_t end_us = options_.clock() + kRepeat_us;
    while (!parameters_.contains(index) && options_.clock() < end_us) wait();
    if (parameters_.contains(index)) return parameters_.at(index);
    answer = run(CommandOp::kParameterRead, index);
  }
  return std::nullopt;
}

void CommandSession::start_write(uint16_t index, int32_t value) {
  const StagedParameter staged = stage_parameter(node(), index, value);
  start(CommandOp::kParameterCommit, staged.argument);
  staged_ = staged.frame;
}

std::optional<CommandAnswer> CommandSession::write_parameter(uint16_t index, int32_t value) {
  std::optional<CommandAnswer> answer;
  int stagings = 0;
  for (int attempt = 0; attempt < kMaxBusyAnswers; ++attempt) {
    start_write(index, value);
    while (waiting_) wait();
    answer = take_answer();
    if (!answer.has_value() || answer->done()) break;
    const auto result = static_cast<Result>(answer->result);
    // Staging that was lost looks like a wrong argument.
    if (result == Result::kBadArgument && ++stagings < kMaxStagings) continue;
    if (result != Result::kBusy) break;
    const uint64_t end_us = options_.clock() + kRepeat_us;
    while (options_.clock() < end_us) wait();
  }
  return answer;
}

void CommandSession::emergency_stop() {
  waiting_ = false;
  answer_.reset();
  for (int i = 0; i < 3; ++i) send_protected(frame_of(message::EmergencyStop{0}), stop_counter_);
}

}  // namespace screed
