// A command session over the simulated radio, stepped by the simulation's ticks.
#include "tools/screed/viewer/keyboard_driver.h"

#include <cmath>
#include <utility>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "hal/sample.h"
#include "host_sim/ground_station/telemetry/schema.h"
#include "schema/class_values.h"
#include "tools/screed/cli/parameter_names.h"

namespace screed::viewer {
namespace {

constexpr int kDriveAlgorithm = static_cast<int>(message::LevelingAlgorithm::kDrive);
constexpr uint64_t kCommandTicks = kTickRate_hz / 4;
constexpr uint64_t kStopRepeatTicks = kTickRate_hz / 5;

uint32_t drive_argument(const DriveCommand& command) {
  uint8_t bytes[3];
  put_drive_argument(bytes, {static_cast<int16_t>(std::lround(command.speed_m_per_s * 1000.0)),
                             static_cast<int16_t>(std::lround(command.yaw_rate_deg_per_s * 10.0))});
  return bytes[0] | static_cast<uint32_t>(bytes[1]) << 8U | static_cast<uint32_t>(bytes[2]) << 16U;
}

std::string algorithm_name(uint8_t algorithm) {
  static const SignalInfo& signal = *find_signal("leveling.algorithm").signal;
  const char* const name = signal.value_name(algorithm);
  return name == nullptr ? "an unknown algorithm" : name;
}

bool same(const DriveCommand& a, const DriveCommand& b) {
  return drive_argument(a) == drive_argument(b);
}

}  // namespace

KeyboardDriver::KeyboardDriver(const CommandKey& key, int algorithm, GroundPort* beside)
    : key_(key),
      first_algorithm_(algorithm),
      algorithm_(algorithm),
      beside_(beside),
      reported_algorithm_(static_cast<uint8_t>(algorithm)) {}

void KeyboardDriver::begin() {
  if (session_.has_value()) return;
  SessionOptions options;
  options.key = key_;
  options.clock = [this] { return ticks_ * kTickPeriod_us; };
  options.on_frame = [this](const LinkFrame& frame) {
    if (check_received(frame.frame, false) == FrameFault::kNone)
      said_.add_frame(frame.time_us, frame.frame, *find_message(frame.frame.id));
  };
  session_.emplace(static_cast<Link&>(*this), std::move(options));
}

void KeyboardDriver::note_frame(const CanFrame& frame) {
  const uint16_t id = exchange_node_1(frame.id, node_of_robot(key_.robot_id));
  if (id == kIdHeartbeat && frame.size == message::Heartbeat::kSize) {
    const auto heartbeat = message::Heartbeat::unpack(frame.data);
    state_ = static_cast<RobotState>(heartbeat.state);
    emergency_stopped_ =
        state_ == RobotState::kFault && (heartbeat.faults & Fault::kEmergencyStop) != 0;
    // A heartbeat that was on its way may tell of an earlier stop.
    if (emergency_stopped_ && ticks_ >= confirmed_from_tick_) stopping_ = false;
  } else if (id == kIdLeveling && frame.size == message::Leveling::kSize) {
    reported_algorithm_ = message::Leveling::unpack(frame.data).algorithm;
  }
}

/// A program that sends heartbeats is a ground station.
void KeyboardDriver::listen_beside(std::span<const uint8_t> bytes) {
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    if (beside_parser_.feed(byte, frame) && frame.id == kIdGroundHeartbeat) external_ = true;
  }
}

void KeyboardDriver::drive(const DriveCommand& command, bool gamepad) {
  begin();
  gamepad_ = gamepad;
  wanted_ = kDriveAlgorithm;
  command_ = command;
}

void KeyboardDriver::hand_back() {
  if (!wanted_.has_value()) return;
  wanted_ = first_algorithm_;
  command_ = {};
}

void KeyboardDriver::emergency_stop() {
  begin();
  command_ = {};
  clear_ = false;
  step_ = Step::kNone;
  stopping_ = true;
  next_stop_tick_ = ticks_;
  confirmed_from_tick_ = ticks_ + kStopRepeatTicks;
}

void KeyboardDriver::clear_fault() {
  if (!session_.has_value() || stopping_ || state_ != RobotState::kFault) return;
  if (!wanted_.has_value()) wanted_ = first_algorithm_;
  clear_ = true;
}

bool KeyboardDriver::drives() const {
  return wanted_.has_value() && *wanted_ == kDriveAlgorithm;
}

std::string KeyboardDriver::description() const {
  if (stopping_) return "EMERGENCY STOP is sent ...";
  if (emergency_stopped_) {
    return session_.has_value() ? "EMERGENCY STOP: C clears it and drives on" : "EMERGENCY STOP";
  }
  if (!wanted_.has_value()) return "";
  if (state_ == RobotState::kFault) return "fault: C clears it when its cause is gone";
  if (!refusal_.empty()) return refusal_;
  if (!drives()) {
    return algorithm_ == *wanted_ && state_ == RobotState::kRunning ? "" : "handing back ...";
  }
  if (algorithm_ != kDriveAlgorithm || state_ != RobotState::kRunning) return "taking over ...";
  return gamepad_ ? "the gamepad drives" : "the keyboard drives";
}

Driver KeyboardDriver::driver() const {
  Driver driver;
  driver.external_link = external_ && !session_.has_value();
  if (reported_algorithm_ != kDriveAlgorithm) {
    driver.algorithm = algorithm_name(reported_algorithm_);
  } else if (drives()) {
    driver.kind = gamepad_ ? Driver::Kind::kGamepad : Driver::Kind::kKeyboard;
  } else {
    driver.kind = external_ ? Driver::Kind::kExternalStation : Driver::Kind::kSimulatedStation;
  }
  return driver;
}

void KeyboardDriver::send(std::span<const uint8_t> bytes) {
  if (beside_ != nullptr) beside_->send(bytes);
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    if (!parser_.feed(byte, frame)) continue;
    if (check_frame(frame) == FrameFault::kNone) note_frame(frame);
    LinkFrame arrived;
    arrived.time_us = ticks_ * kTickPeriod_us;
    arrived.frame = frame;
    arrived_.push_back(arrived);
  }
  if (!session_.has_value()) arrived_.clear();
}

std::vector<uint8_t> KeyboardDriver::receive() {
  ++ticks_;
  std::vector<uint8_t> bytes;
  if (beside_ != nullptr) bytes = beside_->receive();
  listen_beside(bytes);
  if (!session_.has_value()) return bytes;
  session_->pump(std::chrono::milliseconds(0));
  if (stopping_ && ticks_ >= next_stop_tick_) {
    session_->emergency_stop();
    next_stop_tick_ = ticks_ + kStopRepeatTicks;
  }
  if (!session_->waiting()) {
    if (step_ != Step::kNone) finish_command(session_->take_answer());
    const bool may_command = wanted_.has_value() && !stopping_ && session_->ready();
    if (ticks_ >= next_command_tick_ && may_command) next_command();
  }
  bytes.insert(bytes.end(), to_send_.begin(), to_send_.end());
  to_send_.clear();
  return bytes;
}

void KeyboardDriver::receive(std::chrono::milliseconds /*wait*/, std::vector<LinkFrame>& frames) {
  frames.insert(frames.end(), arrived_.begin(), arrived_.end());
  arrived_.clear();
}

bool KeyboardDriver::send(const CanFrame& frame) {
  uint8_t line[kSlcanLineMax];
  const uint8_t length = slcan_encode(frame, line);
  to_send_.insert(to_send_.end(), line, line + length);
  return true;
}

void KeyboardDriver::start(Step step, CommandOp op, uint32_t argument) {
  step_ = step;
  session_->start(op, argument);
}

void KeyboardDriver::next_command() {
  next_command_tick_ = ticks_ + kCommandTicks;
  if (state_ == RobotState::kFault) {
    if (clear_) start(Step::kClear, CommandOp::kClear);
    clear_ = false;
    return;
  }
  if (algorithm_ != *wanted_) {
    if (state_ != RobotState::kDisarmed) {
      start(Step::kDisarm, CommandOp::kDisarm);
    } else {
      step_ = Step::kAlgorithm;
      session_->start_write(parameter_index("algorithm"), *wanted_);
    }
    return;
  }
  switch (state_) {
    case RobotState::kDisarmed:
      start(Step::kArm, CommandOp::kArm);
      return;
    case RobotState::kArmed:
    case RobotState::kStopped:
      start(Step::kRun, CommandOp::kRun);
      return;
    default:
      break;
  }
  if (drives() && (!command_is_sent_ || !same(command_, sent_))) {
    sent_ = command_;
    command_is_sent_ = true;
    start(Step::kDrive, CommandOp::kDrive, drive_argument(command_));
  }
}

void KeyboardDriver::finish_command(const std::optional<CommandAnswer>& answer) {
  const Step step = std::exchange(step_, Step::kNone);
  const bool done = answer.has_value() && answer->done();
  refusal_ = done                 ? ""
             : answer.has_value() ? answer_text(*answer, said_, ticks_ * kTickPeriod_us)
                                  : "the robot does not answer";
  if (!done) {
    if (step == Step::kDrive) command_is_sent_ = false;
    return;
  }
  // Known before the next heartbeat says so.
  switch (step) {
    case Step::kClear:
    case Step::kDisarm:
      state_ = RobotState::kDisarmed;
      break;
    case Step::kAlgorithm:
      algorithm_ = *wanted_;
      command_is_sent_ = false;
      break;
    case Step::kArm:
      state_ = RobotState::kArmed;
      break;
    case Step::kRun:
      state_ = RobotState::kRunning;
      command_is_sent_ = false;
      break;
    default:
      break;
  }
}

}  // namespace screed::viewer
