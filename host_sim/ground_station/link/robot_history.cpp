// What a robot has said so far.
#include "host_sim/ground_station/link/robot_history.h"

#include <algorithm>
#include <cstdio>

#include "firmware/protocol/messages.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/link/command_session.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "host_sim/ground_station/telemetry/candump_log.h"

namespace screed {

namespace {

constexpr size_t kMaxEvents = 100;
/// Robots of one link; beyond it addresses are noise.
constexpr size_t kMaxHistories = 64;
constexpr int kCounterModulus = 16;

const SignalInfo* with_role(const MessageInfo& message, SignalRole role) {
  const auto signal = std::find_if(message.signals.begin(), message.signals.end(),
                                   [role](const SignalInfo& s) { return s.role == role; });
  return signal == message.signals.end() ? nullptr : &*signal;
}

}  // namespace

std::string RobotKey::text() const {
  std::string words = "robot " + std::to_string(node);
  if (address == 0) return words;
  char hex[24];
  std::snprintf(hex, sizeof hex, address <= 0xFFFF ? " at %04llX" : " at %016llX",
                static_cast<unsigned long long>(address));
  return words + hex;
}

void RobotHistory::add_frame(const LinkFrame& frame, const MessageInfo& message) {
  if (frames_ == 0) first_us_ = frame.time_us;
  ++frames_;
  last_us_ = std::max(last_us_, frame.time_us);
  if (frame.source.has_value() && frame.source->rssi_dbm.has_value())
    rssi_dbm_ = frame.source->rssi_dbm;

  latest_.add_frame(frame.time_us, frame.frame, message);
  std::deque<Sample>& samples = samples_[message.id];
  Sample sample{frame.time_us, frame_bytes(frame.frame), 0};
  const Sample* const before = samples.empty() ? nullptr : &samples.front();
  const SignalInfo* const counter = with_role(message, SignalRole::kCounter);
  if (before != nullptr && counter != nullptr) {
    const auto step = counter->raw(sample.data.data()) - counter->raw(before->data.data());
    // The same number again is a robot that restarted, or a doubled frame: no loss.
    if (step != 0)
      sample.missed = static_cast<uint8_t>((step - 1 + kCounterModulus) % kCounterModulus);
  }
  lost_ += sample.missed;
  look_for_changes(message, before, sample);
  samples.push_front(sample);
  while (samples.size() > 1 && samples.front().time_us > samples.back().time_us + kHistory_us)
    samples.pop_back();
}

void RobotHistory::note(uint64_t time_us, CellStyle style, std::string words) {
  events_.push_front({time_us, style, std::move(words)});
  if (events_.size() > kMaxEvents) events_.pop_back();
}

void RobotHistory::note_flags(const MessageInfo& heartbeat, const Sample* before,
                              const Sample& now) {
  const auto said = message::Heartbeat::unpack(now.data.data());
  const bool disarmed =
      static_cast<message::HeartbeatState>(said.state) == message::HeartbeatState::kDisarmed;
  for (const FlagInfo& flag : flags_of(heartbeat.title, "faults")) {
    const bool is = (said.faults & flag.bit) != 0;
    const bool was = before != nullptr && flag.signal->raw(before->data.data()) != 0;
    if (is && !was) {
      const auto sentences = fault_sentences(static_cast<uint16_t>(flag.bit), latest_);
      note(now.time_us, disarmed ? CellStyle::kWarning : CellStyle::kAlarm,
           (disarmed ? "prevents arming: " : "fault: ") + sentences.front());
    }
    if (!is && was) note(now.time_us, CellStyle::kGood, "gone: " + display_name(flag.signal->name));
  }
}

void RobotHistory::look_for_changes(const MessageInfo& message, const Sample* before,
                                    const Sample& now) {
  const uint8_t* const data = now.data.data();
  if (message.id == find_message("HEARTBEAT")->id) {
    const SignalInfo& state = *message.signal("state");
    const int64_t state_now = state.raw(data);
    if (before == nullptr || state.raw(before->data.data()) != state_now)
      note(now.time_us, CellStyle::kTitle, "state: " + display_name(state.text(state_now)));
    note_flags(message, before, now);
    const SignalInfo* const epoch = message.signal("boot_epoch");
    if (before != nullptr && epoch != nullptr &&
        epoch->raw(before->data.data()) != epoch->raw(data))
      note(now.time_us, CellStyle::kWarning,
           "the robot restarted, start " + epoch->text(epoch->raw(data)));
  } else if (message.id == find_message("COMMAND_ACK")->id) {
    const auto ack = message::CommandAck::unpack(data);
    const CommandAnswer answer = {ack.op, ack.result, ack.detail};
    // Reading changes nothing, and programs do it by themselves.
    if (answer.done() && static_cast<CommandOp>(ack.op) == CommandOp::kParameterRead) return;
    note(now.time_us, answer.done() ? CellStyle::kGood : CellStyle::kWarning,
         display_name(message.signal("op")->text(ack.op)) + ": " +
             answer_text(answer, latest_, now.time_us, CommandStyle::kKeys));
  } else if (message.id == find_message("EVENT")->id) {
    const SignalInfo& code = *message.signal("code");
    // The heartbeat reports every change of state, in full.
    if (code.raw(data) == static_cast<int64_t>(message::EventCode::kState)) return;
    const SignalInfo& argument = *message.signal("argument");
    note(now.time_us, CellStyle::kNormal,
         "event: " + display_name(code.text(code.raw(data))) + ", " +
             argument.text(argument.raw(data)));
  }
}

const std::deque<RobotHistory::Sample>& RobotHistory::history(const MessageInfo& message) const {
  static const std::deque<Sample> kNone;
  const auto samples = samples_.find(message.id);
  return samples == samples_.end() ? kNone : samples->second;
}

std::optional<int64_t> RobotHistory::raw(std::string_view path) const {
  return latest_.raw(path);
}

std::optional<double> RobotHistory::value(std::string_view path) const {
  return latest_.value(path);
}

std::string RobotHistory::text(std::string_view path) const {
  return latest_.text(path);
}

std::vector<CurvePoint> RobotHistory::curve(const SignalRef& place, uint64_t now_us,
                                            double window_s) const {
  std::vector<CurvePoint> points;
  for (const Sample& sample : history(*place.message)) {
    const double age_s = (static_cast<double>(now_us) - static_cast<double>(sample.time_us)) * 1e-6;
    if (age_s > window_s) break;
    points.push_back({-age_s, place.signal->value(place.signal->raw(sample.data.data()))});
  }
  std::reverse(points.begin(), points.end());
  return points;
}

std::vector<std::string> RobotHistory::faults() const {
  const LatestTelemetry::Frame* const last = latest_.frame(*find_message("HEARTBEAT"));
  if (last == nullptr) return {};
  return fault_sentences(message::Heartbeat::unpack(last->data.data()).faults, latest_);
}

std::vector<std::string> RobotHistory::obstacles(uint64_t now_us) const {
  return arming_obstacles(latest_, now_us);
}

double RobotHistory::rate_hz(const MessageInfo& message, uint64_t now_us) const {
  const std::deque<Sample>& samples = history(message);
  const uint64_t begin_us = now_us > kWindow_us ? now_us - kWindow_us : 0;
  const auto recent = std::find_if(samples.begin(), samples.end(),
                                   [&](const Sample& s) { return s.time_us < begin_us; });
  // Of a robot that was heard for a shorter time, over that time.
  const uint64_t heard_us =
      std::clamp<uint64_t>(now_us - std::min(first_us_, now_us), 1'000'000U, kWindow_us);
  return static_cast<double>(recent - samples.begin()) * 1e6 / static_cast<double>(heard_us);
}

double RobotHistory::frames_per_s(uint64_t now_us) const {
  double sum = 0.0;
  for (const MessageInfo& message : messages()) sum += rate_hz(message, now_us);
  return sum;
}

std::optional<double> RobotHistory::loss_percent(uint64_t now_us) const {
  uint64_t got = 0;
  uint64_t missed = 0;
  for (const auto& [id, samples] : samples_) {
    for (const Sample& sample : samples) {
      if (sample.time_us + kWindow_us < now_us) break;
      ++got;
      missed += sample.missed;
    }
  }
  if (got == 0) return std::nullopt;
  return 100.0 * static_cast<double>(missed) / static_cast<double>(got + missed);
}

const RobotHistory* FleetView::robot(uint8_t node) const {
  const auto found = std::find_if(robots_.begin(), robots_.end(),
                                  [node](const auto& robot) { return robot.first.node == node; });
  return found == robots_.end() ? nullptr : &found->second;
}

RobotHistory* FleetView::add_frame(const LinkFrame& frame) {
  switch (check_frame(frame.frame)) {
    case FrameFault::kNone:
      break;
    case FrameFault::kUnknownId:
      ++unknown_;
      return nullptr;
    default:
      ++damaged_;
      return nullptr;
  }
  const MessageInfo& message = *find_message(frame.frame.id);
  if (message.uplink) {
    ++uplink_;
    return nullptr;
  }
  const RobotKey key{frame.source.has_value() ? frame.source->address : 0, node_of(frame.frame.id)};
  if (robots_.size() >= kMaxHistories && !robots_.contains(key)) return nullptr;
  RobotHistory& robot = robots_[key];
  robot.add_frame(frame, message);
  return &robot;
}

// Lines to robots.

RobotLogCounts read_robot_log(const std::string& log,
                              const std::function<void(const RobotLogFrame&)>& take) {
  CandumpReader reader(log);
  FleetView fleet;
  RobotLogCounts counts;
  LineKind kind{};
  LoggedFrame logged;
  while (reader.next(kind, logged)) {
    if (kind == LineKind::kUnreadable || kind == LineKind::kUntimed) ++counts.unreadable_lines;
    if (kind != LineKind::kFrame) continue;
    LinkFrame frame;
    frame.time_us = logged.time_us;
    frame.frame = logged.frame;
    const RobotHistory* const robot = fleet.add_frame(frame);
    if (robot == nullptr) continue;
    // A log does not say which module a frame came from: the node tells robots apart.
    const RobotKey key{0, node_of(frame.frame.id)};
    take({key, *robot, frame, *find_message(frame.frame.id)});
  }
  counts.damaged_frames = fleet.damaged();
  if (fleet.robots().empty()) {
    throw InputError(log + ": holds no frame of a robot; " +
                     std::to_string(counts.unreadable_lines) + " of " +
                     std::to_string(reader.line_number()) + " lines cannot be read");
  }
  return counts;
}

}  // namespace screed
