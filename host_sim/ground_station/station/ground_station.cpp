// The simulated ground station, its camera, and its port.
#include "host_sim/ground_station/station/ground_station.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "firmware/protocol/e2e.h"
#include "hal/sample.h"
#include "host_sim/ground_station/telemetry/candump_line.h"

namespace screed {

namespace {

// Fixes go up in ticks of their own: heartbeats take every 20th, other commands 12 of 25.
constexpr std::uint64_t kSlotTicks = kTickRate_hz / 4;
constexpr std::uint64_t kSlot = 7;
constexpr double kMaxCm = 2047.0;  // 12 bits

std::int16_t centimetres(double metres) {
  return static_cast<std::int16_t>(std::lround(std::clamp(metres * 100.0, -kMaxCm, kMaxCm)));
}

}  // namespace

PositionFixes::PositionFixes(std::uint64_t seed, const PositionFixOptions& options)
    : options_(options),
      period_ticks_(options.period_s <= 0.0
                        ? 0
                        : kSlotTicks * static_cast<std::uint64_t>(
                                           std::max(1L, std::lround(options.period_s * 4.0)))),
      random_(seed, "position fixes"),
      outages_(seed, "position fix outages"),
      outage_begins_s_(next_outage_s()) {}

double PositionFixes::next_outage_s() {
  if (options_.outage_every_s <= 0.0) return std::numeric_limits<double>::infinity();
  return -options_.outage_every_s * std::log(1.0 - outages_.uniform());
}

std::optional<DriveArgument> PositionFixes::at(std::uint64_t tick, double x_m, double y_m) {
  if (period_ticks_ == 0 || tick % period_ticks_ != kSlot) return std::nullopt;
  // Drawn for every fix: outages leave the noise of the others as it is.
  const double x = x_m + options_.sigma_m * random_.normal();
  const double y = y_m + options_.sigma_m * random_.normal();
  const double now_s = static_cast<double>(tick) / kTickRate_hz;
  while (now_s >= outage_begins_s_ + options_.outage_s)
    outage_begins_s_ += options_.outage_s + next_outage_s();
  if (now_s >= outage_begins_s_) return std::nullopt;
  return DriveArgument{centimetres(x), centimetres(y)};
}

// The ground station of a simulated run.

namespace {

constexpr uint64_t kHeartbeatTicks = kTickRate_hz / 5;
constexpr uint64_t kCommandTicks = kTickRate_hz / 4;
// Apart from heartbeats, other commands and fixes.
constexpr uint64_t kChangeTicks = kTickRate_hz / 2;
constexpr uint64_t kChangeSlot = 18;

}  // namespace

void GroundStation::receive(uint64_t now_us, std::span<const uint8_t> bytes) {
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    if (parser_.feed(byte, frame)) handle_message(now_us, frame);
  }
}

void GroundStation::handle_message(uint64_t now_us, const CanFrame& frame) {
  if (!e2e_check(frame.id, frame.data, frame.size)) {
    ++rejected_;
    return;
  }
  ++frames_;
  const uint16_t id = exchange_node_1(frame.id, signer_.node());
  if (id == kIdHeartbeat && frame.size == message::Heartbeat::kSize) {
    const message::Heartbeat heartbeat = message::Heartbeat::unpack(frame.data);
    report_.heard = true;
    report_.state = static_cast<RobotState>(heartbeat.state);
    report_.faults = heartbeat.faults;
    if (report_.state == RobotState::kRunning) started_ = true;
  }
  if (id == kIdCommandAck && frame.size == message::CommandAck::kSize) {
    report_.answer = message::CommandAck::unpack(frame.data);
    handle_answer(*report_.answer);
  }
  signer_.handle_frame(frame);
  if (log_ == nullptr) return;
  *log_ << candump_line(now_us, "screed0", frame);
}

void GroundStation::handle_answer(const message::CommandAck& answer) {
  if (changes_.values.empty() || answer.op != static_cast<uint8_t>(CommandOp::kParameterCommit) ||
      answer.freshness != commit_) {
    return;
  }
  const auto first = changes_.values.begin();
  const auto result = static_cast<RequestResult>(answer.result);
  if (result == RequestResult::kDone) changes_.values.erase(first);
  // It may be refused beside another one that is still to come.
  if (result == RequestResult::kBadArgument) std::rotate(first, first + 1, changes_.values.end());
}

void GroundStation::add_change(std::vector<uint8_t>& lines) {
  const auto& [number, value] = changes_.values.front();
  const StagedParameter staged = stage_parameter(signer_.node(), number, value);
  add_frame(staged.frame, stage_counter_, lines);
  const CanFrame commit = signer_.sign(CommandOp::kParameterCommit, staged.argument);
  add_line(commit, lines);
  commit_ = commit.data[kCommandFreshnessOffset];
}

void GroundStation::add_frame(CanFrame frame, uint8_t& counter, std::vector<uint8_t>& lines) {
  e2e_protect(frame.id, counter, frame.data, frame.size);
  counter = static_cast<uint8_t>((counter + 1) & 0x0F);
  add_line(frame, lines);
}

void GroundStation::add_line(const CanFrame& frame, std::vector<uint8_t>& lines) {
  uint8_t line[kSlcanLineMax];
  const uint8_t length = slcan_encode(frame, line);
  lines.insert(lines.end(), line, line + length);
}

std::vector<uint8_t> GroundStation::transmit(uint64_t now_us) {
  std::vector<uint8_t> lines;
  const bool heartbeat = ticks_ % kHeartbeatTicks == 0;
  if (heartbeat) {
    add_frame(frame_of(message::GroundHeartbeat{static_cast<uint32_t>(now_us / 1000U)}),
              heartbeat_counter_, lines);
  }
  // Commands between heartbeats, so that no packet holds both.
  if (ticks_ % kCommandTicks == kCommandTicks / 2 && report_.heard) {
    if (report_.state == RobotState::kDisarmed && arm_ && !started_) {
      add_line(signer_.sign(CommandOp::kArm), lines);
    }
    if (report_.state == RobotState::kArmed && arm_) {
      add_line(signer_.sign(CommandOp::kRun), lines);
    }
    drive_is_new_ = true;
  }
  if (drive_is_new_ && !heartbeat) {
    if (report_.state == RobotState::kRunning && drive_.has_value()) {
      const DriveArgument argument = {
          static_cast<int16_t>(std::lround(drive_->speed_m_per_s * 1000.0)),
          static_cast<int16_t>(std::lround(drive_->yaw_rate_deg_per_s * 10.0))};
      add_line(signer_.sign(CommandOp::kDrive, argument), lines);
    }
    drive_is_new_ = false;
  }
  if (fixes_.has_value() && report_.heard) {
    if (const auto fix = fixes_->at(ticks_, robot_x_m_, robot_y_m_))
      add_line(signer_.sign(CommandOp::kPositionFix, *fix), lines);
  }
  if (!changes_.values.empty() && report_.heard && ticks_ % kChangeTicks == kChangeSlot &&
      static_cast<double>(ticks_) >= changes_.at_s * kTickRate_hz) {
    add_change(lines);
  }
  ++ticks_;
  return lines;
}

// The ground end of the radio.

void GroundEnd::tick(uint64_t now_us, GroundStation& station, RadioLink& uplink,
                     RadioLink& downlink) {
  if (port_ != nullptr) {
    const std::vector<uint8_t> bytes = port_->receive();
    listen(bytes);
    uplink.send(now_us, bytes);
  }
  if (!handed_over_) uplink.send(now_us, station.transmit(now_us));
  const std::span<const uint8_t> arrived = downlink.receive(now_us, SIZE_MAX);
  station.receive(now_us, arrived);
  if (port_ != nullptr) port_->send(arrived);
}

void GroundEnd::listen(std::span<const uint8_t> bytes) {
  CanFrame frame{};
  for (const uint8_t byte : bytes) {
    if (outside_.feed(byte, frame) && frame.id == kIdGroundHeartbeat &&
        e2e_check(frame.id, frame.data, frame.size)) {
      handed_over_ = true;
    }
  }
}

}  // namespace screed
