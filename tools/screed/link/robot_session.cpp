// One robot at the other end of a link.
#include "tools/screed/link/robot_session.h"

#include <algorithm>
#include <iostream>

#include "firmware/parameters/parameters.h"
#include "host_sim/core/errors.h"
#include "host_sim/ground_station/telemetry/arming.h"
#include "tools/screed/cli/interrupt.h"
#include "tools/screed/cli/parameter_names.h"

namespace screed {
namespace {

constexpr std::chrono::milliseconds kPump{20};
constexpr uint64_t kAnswerTimeout_us = 3'000'000;
constexpr uint64_t kStopPeriod_us = 200'000;
constexpr char kNoAnswer[] = "no answer";

}  // namespace

std::string not_heard_text(const FleetView& fleet, const CommandSession& session) {
  if (fleet.robots().empty()) return "no robot is heard";
  return fleet.robots().begin()->first.text() + " is heard, but the key is that of robot " +
         std::to_string(session.node()) +
         "; --key names another, make flash NODE=N gives a robot its number";
}

RobotSession::RobotSession(const LinkArguments& arguments, const CommandKey& key)
    : link_(open_link(arguments)),
      session_(*link_, {key,
                        true,
                        [this](const LinkFrame& frame) { fleet_.add_frame(frame); },
                        {},
                        [] { stop_if_interrupted("waiting for the robot's answer"); }}) {
  catch_interrupts();
}

void RobotSession::meet() {
  const uint64_t end_us = wall_clock_us() + kAnswerTimeout_us;
  const auto heard = [this] {
    const RobotHistory* const robot = fleet_.robot(session_.node());
    return robot != nullptr && robot->value("heartbeat.link_alive").value_or(0.0) != 0.0;
  };
  while (wall_clock_us() < end_us && !(session_.ready() && heard())) {
    stop_if_interrupted("waiting for the robot");
    session_.pump(kPump);
  }
  if (!link_->status().up) throw RunError(link_->name() + ": " + link_->status().text);
  if (!session_.ready()) throw RunError(link_->name() + ": " + not_heard_text(fleet_, session_));
}

std::optional<int> RobotSession::node() const {
  if (fleet_.robot(session_.node()) == nullptr) return std::nullopt;
  return session_.node();
}

std::string RobotSession::reason(const std::optional<CommandAnswer>& answer) {
  const RobotHistory* const view = fleet_.robot(session_.node());
  if (!answer.has_value() || view == nullptr) return kNoAnswer;
  const LatestTelemetry& robot = view->latest();
  if (answer->result == static_cast<uint8_t>(message::CommandAckResult::kFaultPresent)) {
    // The sentences name the robot's own limits.
    std::optional<CommandAnswer> read;
    for (const std::string_view limit : limits_to_read(answer->detail, robot))
      session_.read_parameter(parameter_index(std::string(limit)), read);
  }
  return refusal_text(*answer, robot, wall_clock_us());
}

bool RobotSession::say(const std::string& what, const std::optional<CommandAnswer>& answer) {
  const std::string why_not = reason(answer);
  const char* const refused = why_not.empty() ? "done" : why_not == kNoAnswer ? "" : "refused: ";
  std::cout << what << ": " << refused << why_not << std::endl;
  return why_not.empty();
}

int32_t RobotSession::read_parameter(uint16_t index) {
  std::optional<CommandAnswer> answer;
  const std::optional<int32_t> value = session_.read_parameter(index, answer);
  if (!value.has_value())
    throw RunError(std::string(kParameterTable[index].name) + ": " + reason(answer));
  return *value;
}

std::optional<RobotKey> RobotSession::emergency_stop() {
  // Sent before anything is heard: the robot may be deaf to the ground but not the ground to it.
  session_.emergency_stop();
  const uint64_t end_us = wall_clock_us() + kAnswerTimeout_us;
  uint64_t again_us = wall_clock_us() + kStopPeriod_us;
  while (!interrupted() && wall_clock_us() < end_us) {
    session_.pump(kPump);
    for (const auto& [key, robot] : fleet_.robots()) {
      if (robot.value("heartbeat.emergency_stop").value_or(0.0) == 0.0) continue;
      return key;
    }
    if (wall_clock_us() < again_us) continue;
    session_.emergency_stop();
    again_us += kStopPeriod_us;
  }
  return std::nullopt;
}

void RobotSession::hold() {
  std::cerr << "holding the link; end with Ctrl-C, and the robot stops\n";
  while (!interrupted()) session_.pump(kPump);
}

}  // namespace screed
