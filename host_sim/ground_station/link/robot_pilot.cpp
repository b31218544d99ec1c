// From one state of the robot to the next, a command each.
#include "host_sim/ground_station/link/robot_pilot.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "firmware/parameters/parameters.h"
#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "schema/class_values.h"

namespace screed {
namespace {

constexpr int kDriveAlgorithm = static_cast<int>(message::LevelingAlgorithm::kDrive);
constexpr uint64_t kCommand_us = 250'000;
constexpr uint64_t kStopRepeat_us = 200'000;

uint32_t drive_argument(const DriveCommand& command) {
  return command_argument({static_cast<int16_t>(std::lround(command.speed_m_per_s * 1000.0)),
                           static_cast<int16_t>(std::lround(command.yaw_rate_deg_per_s * 10.0))});
}

}  // namespace

RobotPilot::RobotPilot(Link& link, PilotOptions options)
    : link_(link),
      options_(std::move(options)),
      first_algorithm_(options_.algorithm),
      algorithm_(options_.algorithm) {}

void RobotPilot::begin() {
  if (begun()) return;
  SessionOptions options;
  options.key = options_.key;
  options.clock = options_.clock;
  options.on_frame = [this](const LinkFrame& frame) {
    if (check_received(frame.frame, false) == FrameFault::kNone) {
      said_.add_frame(frame.time_us, frame.frame, *find_message(frame.frame.id));
      note_frame(frame.frame);
    }
    if (options_.on_frame) options_.on_frame(frame);
  };
  session_.emplace(link_, std::move(options));
}

void RobotPilot::note_frame(const CanFrame& frame) {
  const uint16_t id = exchange_node_1(frame.id, node_of_robot(options_.key.robot_id));
  if (id == kIdHeartbeat && frame.size == message::Heartbeat::kSize) {
    const auto heartbeat = message::Heartbeat::unpack(frame.data);
    state_ = static_cast<RobotState>(heartbeat.state);
    emergency_stopped_ =
        state_ == RobotState::kFault && (heartbeat.faults & Fault::kEmergencyStop) != 0;
    // A heartbeat that was on its way may tell of an earlier stop.
    if (emergency_stopped_ && options_.clock() >= confirmed_from_us_) stopping_ = false;
  } else if (id == kIdLeveling && frame.size == message::Leveling::kSize) {
    reported_algorithm_ = message::Leveling::unpack(frame.data).algorithm;
    if (!algorithm_.has_value()) algorithm_ = reported_algorithm_;
    if (!first_algorithm_.has_value()) first_algorithm_ = reported_algorithm_;
  }
}

void RobotPilot::drive(const DriveCommand& command) {
  begin();
  wanted_ = kDriveAlgorithm;
  command_ = command;
  rests_ = false;
}

void RobotPilot::hand_back() {
  if (!wanted_.has_value()) return;
  wanted_ = first_algorithm_;
  command_ = {};
  rests_ = false;
}

void RobotPilot::release() {
  hand_back();
  rests_ = true;
}

bool RobotPilot::released() const {
  return !wanted_.has_value() ||
         (rests_ && algorithm_ == wanted_ &&
          (state_ == RobotState::kDisarmed || state_ == RobotState::kFault));
}

void RobotPilot::emergency_stop() {
  begin();
  command_ = {};
  clear_ = false;
  step_ = Step::kNone;
  stopping_ = true;
  next_stop_us_ = options_.clock();
  confirmed_from_us_ = next_stop_us_ + kStopRepeat_us;
}

void RobotPilot::clear_fault() {
  if (!begun() || stopping_ || state_ != RobotState::kFault) return;
  if (!wanted_.has_value()) wanted_ = first_algorithm_;
  clear_ = true;
}

bool RobotPilot::drives() const {
  return wanted_ == kDriveAlgorithm;
}

bool RobotPilot::in_control() const {
  return drives() && algorithm_ == kDriveAlgorithm && state_ == RobotState::kRunning;
}

bool RobotPilot::handed_back() const {
  return !wanted_.has_value() ||
         (!drives() && algorithm_ == wanted_ && state_ == RobotState::kRunning);
}

std::string RobotPilot::description() const {
  if (stopping_) return "EMERGENCY STOP is sent ...";
  if (emergency_stopped_)
    return begun() ? "EMERGENCY STOP: C clears it and drives on" : "EMERGENCY STOP";
  if (!wanted_.has_value()) return "";
  if (state_ == RobotState::kFault) return "fault: C clears it when its cause is gone";
  if (!refusal_.empty()) return refusal_;
  if (!drives()) return handed_back() ? "" : "handing back ...";
  return in_control() ? "" : "taking over ...";
}

void RobotPilot::pump(std::chrono::milliseconds wait) {
  if (!begun()) return;
  session_->pump(wait);
  const uint64_t now_us = options_.clock();
  if (stopping_ && now_us >= next_stop_us_) {
    session_->emergency_stop();
    next_stop_us_ = now_us + kStopRepeat_us;
  }
  if (session_->waiting()) return;
  if (step_ != Step::kNone) finish_command(session_->take_answer());
  const bool may_command = wanted_.has_value() && !stopping_ && session_->ready();
  if (may_command && now_us >= next_command_us_) next_command();
}

void RobotPilot::start(Step step, CommandOp op, uint32_t argument) {
  step_ = step;
  session_->start(op, argument);
}

void RobotPilot::next_command() {
  if (!state_.has_value() || !algorithm_.has_value()) return;  // it has not said so yet
  next_command_us_ = options_.clock() + kCommand_us;
  if (state_ == RobotState::kFault) {
    if (clear_) start(Step::kClear, CommandOp::kClear);
    clear_ = false;
    return;
  }
  if (algorithm_ != wanted_ || rests_) {
    if (algorithm_ == wanted_ && state_ == RobotState::kDisarmed) return;
    if (state_ != RobotState::kDisarmed) {
      start(Step::kDisarm, CommandOp::kDisarm);
    } else {
      step_ = Step::kAlgorithm;
      session_->start_write(Parameters::k_algorithm, *wanted_);
    }
    return;
  }
  if (state_ == RobotState::kDisarmed) {
    start(Step::kArm, CommandOp::kArm);
  } else if (state_ != RobotState::kRunning) {
    start(Step::kRun, CommandOp::kRun);
  } else if (drives() && sent_ != drive_argument(command_)) {
    sent_ = drive_argument(command_);
    start(Step::kDrive, CommandOp::kDrive, *sent_);
  }
}

void RobotPilot::finish_command(const std::optional<CommandAnswer>& answer) {
  const Step step = std::exchange(step_, Step::kNone);
  const bool done = answer.has_value() && answer->done();
  refusal_ = done                 ? ""
             : answer.has_value() ? answer_text(*answer, said_, options_.clock())
                                  : "the robot does not answer";
  if (!done) {
    sent_.reset();
    return;
  }
  // Known before the next heartbeat says so.
  switch (step) {
    case Step::kClear:
    case Step::kDisarm:
      state_ = RobotState::kDisarmed;
      break;
    case Step::kAlgorithm:
      algorithm_ = wanted_;
      break;
    case Step::kArm:
      state_ = RobotState::kArmed;
      break;
    case Step::kRun:
      state_ = RobotState::kRunning;
      break;
    default:
      return;
  }
  sent_.reset();  // a robot that is started anew stands
}

}  // namespace screed
