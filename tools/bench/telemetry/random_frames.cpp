// Frames of the schema with random content.
#include "tools/bench/telemetry/random_frames.h"

#include <cstring>

#include "firmware/protocol/e2e.h"
#include "firmware/protocol/messages.h"
#include "firmware/security/command_mac.h"

namespace screed {
namespace {

constexpr uint8_t kKey[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
constexpr uint8_t kRobot = 1;
constexpr uint16_t kBootEpoch = 17;
constexpr uint16_t kCounter = 0x0142;  // of the next command that the robot would take

/// The MAC that the robot expects: over what the frame says, its own epoch and counter.
void expected_mac(const CanFrame& frame, uint8_t (&mac)[kSipHashSize]) {
  command_mac(kKey, frame.id, kRobot, kBootEpoch,
              static_cast<uint16_t>((kCounter & 0xFF00U) | frame.data[kCommandFreshnessOffset]),
              frame.data, mac);
}

}  // namespace

CanFrame RandomFrames::next() {
  return fill(messages()[random_.next() % messages().size()]);
}

CanFrame RandomFrames::next(bool uplink) {
  for (;;) {
    const MessageInfo& message = messages()[random_.next() % messages().size()];
    if (message.uplink == uplink) return fill(message);
  }
}

CanFrame RandomFrames::fill(const MessageInfo& message) {
  CanFrame frame{};
  frame.id = id_of_node(message.id, static_cast<uint8_t>(1 + random_.next() % 3));
  frame.size = message.size;
  for (uint8_t i = 0; i < frame.size; ++i) {
    const uint32_t draw = random_.next();
    constexpr uint8_t kEdges[] = {0x00, 0xFF, 0x7F, 0x80};
    frame.data[i] = (draw & 0x100U) != 0 ? static_cast<uint8_t>(draw) : kEdges[draw & 3U];
  }
  if (message.protected_by_crc) {
    uint8_t& counter = counters_[frame.id];
    e2e_protect(frame.id, counter, frame.data, frame.size);
    counter = (counter + 1U) & 0x0FU;
  } else {
    uint8_t mac[kSipHashSize];
    expected_mac(frame, mac);
    std::memcpy(frame.data + kCommandMacOffset, mac, kCommandMacSize);
  }
  return frame;
}

bool RandomFrames::accepts(const CanFrame& frame, bool uplink) {
  if (check_received(frame, uplink) != FrameFault::kNone) return false;
  if (find_message(frame.id)->protected_by_crc) return true;
  uint8_t mac[kSipHashSize];
  expected_mac(frame, mac);
  return std::memcmp(frame.data + kCommandMacOffset, mac, kCommandMacSize) == 0;
}

}  // namespace screed
