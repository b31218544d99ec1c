// The last frame of each message that a robot sent, read by the names of the schema, and the
// parameters that it reported.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/protocol/slcan.h"
#include "host_sim/ground_station/telemetry/schema.h"

namespace screed {

/// The bytes of a frame, zero behind its size.
std::array<uint8_t, 8> frame_bytes(const CanFrame& frame);

class LatestTelemetry {
 public:
  struct Frame {
    uint64_t time_us;
    std::array<uint8_t, 8> data;
  };

  /// Takes a downlink frame that check_frame() found right. Times rise.
  void add_frame(uint64_t time_us, const CanFrame& frame, const MessageInfo& message);

  /// Null when the message never came.
  const Frame* frame(const MessageInfo& message) const;

  /// By "message.signal"; nothing before the message came. Throws as find_signal().
  std::optional<int64_t> raw(std::string_view path) const;
  std::optional<double> value(std::string_view path) const;  ///< in its unit
  /// As people read it, without unit: "2.50", "training drive"; "-" before the message came.
  std::string text(std::string_view path) const;

  /// Seconds since the message came; nothing before.
  std::optional<double> age_s(const MessageInfo& message, uint64_t now_us) const;

  /// A parameter as the robot reported it last, in its unit. Nothing when it has not, or no
  /// parameter has this name.
  std::optional<int32_t> parameter(std::string_view name) const;
  /// For whoever knows the robot's parameters without asking it: as if it had reported this one.
  void set_parameter(std::string_view name, int32_t value);

 private:
  std::map<uint16_t, Frame> frames_;        ///< by the id of node 1
  std::map<uint16_t, int32_t> parameters_;  ///< by index
};

}  // namespace screed
