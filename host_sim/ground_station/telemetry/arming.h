// Why a robot cannot be armed, in words, from what it says of itself. One source a fact: faults and
// their meanings are the schema's, limits are the robot's parameters, measurements its telemetry.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host_sim/ground_station/telemetry/latest_telemetry.h"

namespace screed {

/// One sentence for each reason that the supervisor would refuse to arm, most hindering first.
/// Empty: nothing is known to prevent it, or the robot is armed already, or was not heard.
std::vector<std::string> arming_obstacles(const LatestTelemetry& robot, uint64_t now_us);

/// One sentence for each set bit of HEARTBEAT.faults, with the measurement and its limit where the
/// cause has one: "battery 5.80 V below battery_low 6.00 V".
std::vector<std::string> fault_sentences(uint16_t faults, const LatestTelemetry& robot);

/// "start-up needs 4.5 s at rest, 2.1 s left".
std::string start_up_sentence(const LatestTelemetry& robot, uint64_t now_us);

/// Why the gate that commands pass refused one (COMMAND_ACK.result and detail); nothing for results
/// of other parts of the robot.
std::optional<std::string> gate_refusal(uint8_t result, uint16_t detail);

/// The parameters whose values the sentences of these faults want, and which the robot has not
/// reported yet.
std::vector<std::string_view> limits_to_read(uint16_t faults, const LatestTelemetry& robot);

}  // namespace screed
